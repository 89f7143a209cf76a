// The page: which object lies there, and what happens in every frame.

const find = (id) => document.getElementById(id);
const entries = JSON.parse(find("scenes").textContent);
const live = document.body.dataset.source === "session";
const still = matchMedia("(prefers-reduced-motion: reduce)");
// One scale for all objects of the page, so that they can be compared.
const scale = {
  depth_m: Math.max(...entries.map((entry) => entry.depth_m)),
  free_m: Math.min(0, ...entries.map((entry) => entry.free_m)),
  max_n: Math.max(...entries.map((entry) => entry.max_n)),
  min_n: Math.min(0, ...entries.map((entry) => entry.min_n)),
};
const loops = new Map(); // of objects pressed before, by name

// intent: null where the hand is a real one, elsewhere.
let scene, trace, view, source, rendered_n, intent = null;

function say(text) {
  find("said").textContent = text;
}

function hand() {
  const { hands } = scene, at = (id) => Number(find(id).value);
  return {
    stiffness_npm: hands.stiffness_npm[at("stiffness")],
    mass_kg: hands.mass_kg[at("mass")],
    delay: at("delay"),
    verdict: hands.verdicts[at("stiffness")][at("mass")][at("delay")],
  };
}

function hold() {
  const { hands, entry } = scene, held = hand();
  scene.c.sp_page_device(...hands.device);
  scene.c.sp_page_hold(held.mass_kg, held.stiffness_npm, hands.damping_nspm, hands.own_delay + held.delay);
  // So deep a hand has to intend to be, to reach the greatest force.
  if (intent !== null) intent.deepest_m = entry.depth_m + entry.max_n / held.stiffness_npm;
  read_hand(held);
}

function start() {
  trace = new Trace(scene.entry.dt_s, scene.Real);
  if (live || source instanceof Board) return;
  intent = new Intent(scene.entry.free_m, 1);
  scene.c.sp_page_start(scene.entry.free_m);
  source = new HandOnPage(scene, intent);
  hold();
}

async function show(index) {
  if (trace !== undefined && trace.most_m > 0) loops.set(scene.entry.name, trace.loop());
  scene = await Scene.load(entries[index]);
{% if maps %}
  take_map();
{% endif %}
  loops.delete(scene.entry.name);
  document.documentElement.dataset.object = index % 6;
  palette.clear();
  find("object-name").textContent = scene.entry.name;
  find("what").textContent = scene.entry.what;
  rendered_n = prove();
  view = new ObjectView(find("object"), scene.entry, scale);
  start();
  if (live) source = new Session(scene, say);
  draw_recording(find("recording"), scene, rendered_n);
}

// Another object, when the hand has left this one: no force comes or goes in a jump.
function pick(index) {
  const leave = () => {
    if (intent.now_m > intent.free_m || trace.newest_m > Math.max(0, intent.free_m + 1e-4))
      return requestAnimationFrame(leave);
    return show(index).then(() => say(`Now you press ${scene.entry.name}; the file begins anew.`));
  };
  intent.let_go(performance.now());
  leave();
}

function stop() {
  source.stop?.();
  say("STOP was sent.");
}

function download() {
  save({{ "map?.csv(trace.csv()) ?? " if maps }}trace.csv(), "pressed");
}

function save(text, what) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = `${scene.entry.name}-${what}.csv`;
  link.click();
  URL.revokeObjectURL(link.href);
}

async function connect() {
  try {
    const board = await Board.open(scene, say);
    intent = null;
    trace = new Trace(scene.entry.dt_s, scene.Real);
    source = board;
    find("picker").disabled = true;
    for (const element of document.querySelectorAll(".own-hand")) element.hidden = true;
    for (const element of document.querySelectorAll(".other-hand")) element.hidden = false;
    setTimeout(() => {
      const hash = board.other_hash;
      say(hash === null ? "The board does not answer: is it one that renders?"
        : hash === scene.entry.hash ? "The board renders this scene; the page shows it."
        : `The board renders another scene (${hash.slice(0, 12)}): what it sends is shown all the same.`);
    }, 500);
  } catch (error) {
    say(`No board: ${error.message}`);
  }
}

// For who measures the page from outside.
function count(name, more) {
  document.body.dataset[name] = Number(document.body.dataset[name] ?? 0) + more;
}

function frame(now_ms) {
  const began_ms = performance.now(), had_room = !trace.full;
  let rows = source.advance(now_ms);
  while (rows > 0) {
    trace.take(scene.position_m, scene.force_n, rows, scene.notes);
    rows = intent === null ? source.advance() : 0; // a link may have more
  }
  if (had_room && trace.full) say(`${KEPT_S} s are in the file, and no more: start again to record anew.`);
  view.draw(trace, intent);
{% if maps %}
  draw_map(now_ms);
{% endif %}
  draw_scope(find("scope"), trace, scale, still.matches);
  draw_loop(find("loop"), trace, scene, scale, Array.from(loops, ([name, points]) => ({ name, points })));
  if (trace.count > 0) read_tick(now_ms);
  count("frames", 1);
  count("busy_ms", performance.now() - began_ms);
  document.body.dataset.ticks = trace.count;
  requestAnimationFrame(frame);
}

try {
  await show(0);
  listen();
{% if maps %}
  listen_to_map();
{% endif %}
  document.body.classList.add("ready");
  requestAnimationFrame(frame);
} catch (error) {
  find("broken").textContent = `This page cannot run here: ${error.message}. ` +
    "It needs a browser with WebAssembly and DecompressionStream (all since 2023).";
}
