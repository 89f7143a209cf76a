// The page: which object lies there, what people do to it, and what happens in every frame.

const KEYS = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 };
const READ_MS = 100; // numbers are renewed so often
const find = (id) => document.getElementById(id);
const entries = JSON.parse(find("scenes").textContent);
const pictures = new Pictures({
  depth_m: Math.max(...entries.map((entry) => entry.depth_m)),
  free_m: Math.min(...entries.map((entry) => entry.free_m)),
  max_n: Math.max(...entries.map((entry) => entry.max_n)),
  min_n: Math.min(0, ...entries.map((entry) => entry.min_n)),
});
let scene, trace, intent, read_ms = 0;

async function show(index) {
  scene = await Scene.load(entries[index]);
  const { entry } = scene;
  find("object-name").textContent = entry.name;
  find("what").textContent = entry.what;
  find("selftest").textContent = scene.proof();
  find("hash").textContent = entry.hash.slice(0, 12);
  start();
}

function start() {
  trace = new Trace(scene);
  intent = new Intent(scene.entry.free_m);
  scene.start();
  hold();
}

function hold() {
  const { entry } = scene, stiffness = Number(find("stiffness").value), delay = Number(find("delay").value);
  scene.hold(entry.stiffness_npm[stiffness], delay);
  // So deep a hand has to intend to be, to reach the greatest force.
  intent.deepest_m = entry.depth_m + entry.max_n / entry.stiffness_npm[stiffness];
  find("stiffness-is").textContent = `${entry.stiffness_npm[stiffness]} N/m`;
  find("delay-is").textContent = `${delay} steps`;
  find("verdict").textContent = entry.verdicts[stiffness][delay];
}

function read({ depth_m, force_n, notes }) {
  const depth = `${(1e3 * depth_m).toFixed(2)} mm`, force = `${force_n.toFixed(2)} N`;
  find("depth").textContent = depth;
  find("force").textContent = force;
  find("object").setAttribute("aria-valuenow", (1e3 * depth_m).toFixed(2));
  find("object").setAttribute("aria-valuetext", `${depth} deep, ${force}`);
  const words = scene.entry.notes.filter(([bit]) => notes & bit).map(([, text]) => text);
  find("notes").textContent = words.join(", ") || "fine";
}

function download() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([trace.csv()], { type: "text/csv" }));
  link.download = `${scene.entry.name}-pressed.csv`;
  link.click();
  URL.revokeObjectURL(link.href);
}

function listen() {
  const canvas = find("object");
  let pressing = null;
  const follow = (event) => {
    if (pressing !== event.pointerId) return;
    const all = event.getCoalescedEvents?.() ?? [], { top } = canvas.getBoundingClientRect();
    for (const one of all.length > 0 ? all : [event])
      intent.add(one.timeStamp, pictures.intent_at(one.clientY - top, intent));
  };
  canvas.addEventListener("pointerdown", (event) => {
    pressing = event.pointerId;
    follow(event);
  });
  addEventListener("pointermove", follow);
  for (const kind of ["pointerup", "pointercancel"])
    addEventListener(kind, (event) => {
      if (pressing !== event.pointerId) return;
      pressing = null;
      intent.let_go(event.timeStamp);
    });
  canvas.addEventListener("keydown", (event) => {
    if (event.key in KEYS) intent.key = KEYS[event.key];
    else if (event.key === " ") intent.let_go(performance.now());
    else return;
    event.preventDefault();
  });
  for (const kind of ["keyup", "blur"]) canvas.addEventListener(kind, () => { intent.key = 0; });
  for (const id of ["stiffness", "delay"]) find(id).addEventListener("input", hold);
  find("picker").addEventListener("change", (event) => show(Number(event.target.value)));
  find("download").addEventListener("click", download);
  find("again").addEventListener("click", start);
}

function frame(now_ms) {
  trace.take(scene, scene.advance(now_ms, intent));
  pictures.draw(scene, trace, intent);
  if (now_ms - read_ms > READ_MS) {
    read_ms = now_ms;
    read(trace.now);
  }
  requestAnimationFrame(frame);
}

try {
  await show(0);
  listen();
  document.body.classList.add("ready");
  requestAnimationFrame(frame);
} catch (error) {
  find("broken").textContent = `This page cannot run here: ${error.message}. ` +
    "It needs a browser with WebAssembly and DecompressionStream (all since 2023).";
}
