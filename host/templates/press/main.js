// The page: what is shown, and what people do.

const find = (id) => document.getElementById(id);
const entries = JSON.parse(find("scenes").textContent);
const live = document.body.dataset.source === "session";
const still = matchMedia("(prefers-reduced-motion: reduce)");
const KEYS = { ArrowDown: 1, ArrowUp: -1 };

const COMPILED_MS = 2500; // by then the browser has compiled the C as well as it can

let timing, scene, trace, intent, view, source, rendered_n, peak_n;

function say(text) {
  find("said").textContent = text;
}

// The greatest force of the scene, and how deep a hand has to intend to be to reach it.
function reach() {
  const { max_n, depth_m } = scene.entry;
  intent.deepest_m = depth_m + max_n / hand().stiffness_npm;
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
  const { hands } = scene, { stiffness_npm, mass_kg, delay, verdict } = hand();
  scene.c.sp_page_hold(mass_kg, stiffness_npm, hands.damping_nspm, hands.own_delay + delay);
  find("stiffness-is").textContent = `${stiffness_npm} N/m`;
  find("mass-is").textContent = `${mass_kg} kg`;
  find("delay-is").textContent = delay === 1 ? "1 sample" : `${delay} samples`;
  find("verdict").textContent = verdict.words;
  find("verdict").classList.toggle("bad", !verdict.stable);
  find("limit").textContent =
    `With this hand and delay the object may have ${verdict.limit}; this one has up to ${hands.object_npmm} N/mm.`;
  reach();
}

function start() {
  trace = new Trace(scene.entry.dt_s, scene.Real);
  if (live) return;
  intent = new Intent(scene.entry.free_m, 1);
  scene.c.sp_page_start(scene.entry.free_m);
  source = new HandOnPage(scene, intent);
  hold();
}

async function show(entry) {
  scene = await Scene.load(entry);
  peak_n = 1.1 * entry.max_n;
  find("object-name").textContent = entry.name;
  find("what").textContent = entry.what;
  prove();
  view = new ObjectView(find("object"), entry);
  start();
  if (live) source = new Session(scene, say);
  draw_recording(find("recording"), scene, rendered_n);
}

function prove() {
  const { entry } = scene, wrong = scene.c[`${entry.prefix}_selftest`]();
  const lines = [
    ["scene", entry.hash],
    ["self-test", wrong === 0 ? `0 of ${entry.golden_ticks} ticks differ from the reference`
      : `tick ${wrong - 1} differs from the reference: do not trust this page`],
  ];
  find("recorded").hidden = find("grey").hidden = scene.measured_n.length === 0;
  rendered_n = Float64Array.from(scene.replay());
  if (rendered_n.length > 0) {
    const here = scene.force_crc(rendered_n.length), there = entry.recording.force_crc;
    lines.push(["replay", `${entry.recording.name}: forces ${here} here, ${there} on the PC: ${
      here === there ? "the same bits" : "THEY DIFFER"}`]);
    const error_n = rms_error_n(scene.measured_n, rendered_n);
    find("error").textContent = `${entry.recording.name}, ${rendered_n.length} samples: ${
      error_n.toFixed(3)} N RMS between measured and rendered, ${
      ((100 * error_n) / Math.max(...scene.measured_n)).toFixed(1)} % of the peak. ${entry.recording.seen}`;
  }
  lines.push(["size", `${(entry.wasm_bytes / 1e3).toFixed(1)} kB of WebAssembly, from the C that a board compiles`]);
  find("proof").replaceChildren(...lines.flatMap(row));
  clearTimeout(timing);
  timing = setTimeout(() => find("proof").append(...row(["a tick", `${
    scene.tick_us().toPrecision(2)} us in this browser, of ${
    Number((1e6 * entry.dt_s).toPrecision(4))} us that it may take`])), COMPILED_MS);
}

function row([name, text]) {
  const term = document.createElement("dt"), words = document.createElement("dd");
  term.textContent = name;
  words.textContent = text;
  return [term, words];
}

function notes_in_words(notes) {
  const words = scene.entry.notes.filter(([bit]) => notes & bit).map(([, text]) => text);
  return words.length > 0 ? words.join(", ") : "fine";
}

let spoken = "fine", spoken_ms = 0;

function read_out(now_ms, rows) {
  if (rows === 0) return;
  const depth = (1e3 * trace.newest_m).toFixed(2), force = trace.newest_n.toFixed(2);
  find("depth").textContent = `${depth} mm`;
  find("force").textContent = `${force} N`;
  find("vibration").textContent = `${(1e3 * trace.vibration_mps).toFixed(1)} mm/s`;
  const notes = notes_in_words(scene.notes[rows - 1]);
  if (notes !== spoken && now_ms - spoken_ms > 300) [spoken, spoken_ms] = [notes, now_ms];
  find("notes").textContent = spoken;
  find("object").setAttribute("aria-valuenow", depth);
  find("object").setAttribute("aria-valuetext", `${depth} mm deep, ${force} N`);
  find("kept").textContent = trace.full
    ? `${KEPT_S} s are kept, no more: start again to record anew` : "";
}

// For who measures the page from outside.
function count(name, more) {
  document.body.dataset[name] = Number(document.body.dataset[name] ?? 0) + more;
}

function frame(now_ms) {
  const began_ms = performance.now();
  let rows = 0, newest = source.advance(now_ms);
  for (; newest > 0; newest = source === undefined || source instanceof HandOnPage ? 0 : source.advance()) {
    trace.take(scene.position_m, scene.force_n, newest);
    rows = newest;
  }
  view.draw(trace, intent ?? null, peak_n);
  draw_scope(find("scope"), trace, scene.entry, peak_n, still.matches);
  draw_loop(find("loop"), trace, scene, peak_n);
  read_out(now_ms, rows);
  count("frames", 1);
  count("busy_ms", performance.now() - began_ms);
  document.body.dataset.ticks = trace.count;
  requestAnimationFrame(frame);
}

function press_with_pointer(canvas) {
  let pressing = null;
  const follow = (event) => {
    if (pressing !== event.pointerId) return;
    const all = event.getCoalescedEvents?.() ?? [];
    const top = canvas.getBoundingClientRect().top;
    for (const one of all.length > 0 ? all : [event])
      intent.add(one.timeStamp, view.intent_at(one.clientY - top, intent));
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (intent === undefined) return;
    pressing = event.pointerId;
    find("hint").hidden = true;
    follow(event);
  });
  addEventListener("pointermove", follow);
  for (const kind of ["pointerup", "pointercancel"])
    addEventListener(kind, (event) => {
      if (pressing !== event.pointerId) return;
      pressing = null;
      intent.let_go(event.timeStamp);
    });
}

function press_with_keys(canvas) {
  canvas.addEventListener("keydown", (event) => {
    if (event.key in KEYS && intent !== undefined) {
      find("hint").hidden = true;
      intent.key = KEYS[event.key];
    } else if (event.key === " " && intent !== undefined) intent.let_go(performance.now());
    else return;
    event.preventDefault();
  });
  canvas.addEventListener("keyup", (event) => {
    if (event.key in KEYS && intent !== undefined) intent.key = 0;
  });
  canvas.addEventListener("blur", () => { if (intent !== undefined) intent.key = 0; });
}

function stop() {
  source.stop?.();
  say("STOP was sent.");
}

// Another object, when the hand has left this one: no force comes or goes in a jump.
function pick(index) {
  const leave = () => {
    if (intent.now_m > intent.free_m || trace.newest_m > Math.max(0, intent.free_m + 1e-4))
      return requestAnimationFrame(leave);
    return show(entries[index]).then(() => say(`${scene.entry.name} lies there now.`));
  };
  intent.let_go(performance.now());
  leave();
}

function download() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([trace.csv()], { type: "text/csv" }));
  link.download = `${scene.entry.name}-pressed.csv`;
  link.click();
  URL.revokeObjectURL(link.href);
}

async function connect() {
  try {
    const board = await Board.open(scene, say);
    intent = undefined;
    trace = new Trace(scene.entry.dt_s, scene.Real);
    source = board;
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

function listen() {
  const canvas = find("object");
  press_with_pointer(canvas);
  press_with_keys(canvas);
  for (const id of ["stiffness", "mass", "delay"]) find(id).addEventListener("input", hold);
  find("picker").addEventListener("change", (event) => pick(Number(event.target.value)));
  find("download").addEventListener("click", download);
  find("again").addEventListener("click", start);
  find("stop").addEventListener("click", stop);
  find("reset").addEventListener("click", () => source.reset?.());
  addEventListener("keydown", (event) => { if (event.key === "q" && !find("stop").hidden) stop(); });
  find("connect").hidden = live || !("serial" in navigator);
  find("connect").addEventListener("click", connect);
  for (const change of ["resize", "focus"])
    addEventListener(change, () => draw_recording(find("recording"), scene, rendered_n));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    palette.clear();
    draw_recording(find("recording"), scene, rendered_n);
  });
}

try {
  await show(entries[0]);
  listen();
  document.body.classList.add("ready");
  requestAnimationFrame(frame);
} catch (error) {
  find("broken").textContent = `This page cannot run here: ${error.message}. ` +
    "It needs a browser with WebAssembly and DecompressionStream (all since 2023).";
}
