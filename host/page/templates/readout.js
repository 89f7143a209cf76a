// What the page says in words and numbers: the proof, the hand's verdict, the newest tick.

const COMPILED_MS = 2500; // by then the browser has compiled the C as well as it can
const SPOKEN_MS = 300; // words that come and go faster are not shown

const READ_MS = 100;
const VIBRATES_MPS = 0.01; // more than a press by hand has

let timing, spoken = "", spoken_ms = 0, read_ms = -READ_MS;

function row([name, text]) {
  const term = document.createElement("dt"), words = document.createElement("dd");
  term.textContent = name;
  words.textContent = text;
  return [term, words];
}

// Self-test, and the recording through the C: its forces.
function prove() {
  const { entry } = scene, wrong = scene.c[`${entry.prefix}_selftest`]();
  const found_n = Float64Array.from(scene.replay()), recorded = found_n.length > 0;
  const lines = [
    ["scene", entry.hash],
    ["self-test", wrong === 0 ? `0 of ${entry.golden_ticks} steps differ from the reference`
      : `step ${wrong - 1} differs from the reference: do not trust this page`],
  ];
  if (recorded) {
    const here = scene.force_crc(found_n.length), there = entry.recording.force_crc;
    lines.push(["replay", `${entry.recording.name}: forces ${here} here, ${there} on the PC: ${
      here === there ? "the same bits" : "THEY DIFFER"}`]);
  }
  lines.push(["size", `${(entry.wasm_bytes / 1e3).toFixed(1)} kB of WebAssembly, from the C that a board compiles`]);
  lines.push(["a step", "is being timed"]);
  find("proof").replaceChildren(...lines.flatMap(row));
  find("tick").textContent = scene.tick_c;
  clearTimeout(timing);
  timing = setTimeout(() => {
    find("proof").lastElementChild.textContent = `${scene.tick_us().toPrecision(2)} us in this browser, of ${
      Number((1e6 * entry.dt_s).toPrecision(4))} us that it may take`;
  }, COMPILED_MS);
  find("grey").hidden = !recorded;
  find("error").textContent = recorded ? accuracy_in_words(found_n)
    : "No recording of this object is on the page.";
  return found_n;
}

function accuracy_in_words(found_n) {
  const { name, seen } = scene.entry.recording, error_n = rms_error_n(scene.measured_n, found_n);
  const share = (100 * error_n) / Math.max(...scene.measured_n);
  return `${name}, ${found_n.length} samples: ${error_n.toFixed(3)} N RMS between measured and rendered, ${
    share.toFixed(1)} % of the peak. ${seen}`;
}

function read_hand({ stiffness_npm, mass_kg, delay, verdict }) {
  const values = { stiffness: `${stiffness_npm} N/m`, mass: `${mass_kg} kg`,
    delay: delay === 1 ? "1 step" : `${delay} steps` };
  for (const [id, text] of Object.entries(values)) {
    find(`${id}-is`).textContent = text;
    find(id).setAttribute("aria-valuetext", text);
  }
  find("verdict").textContent = verdict.words;
  find("verdict").classList.toggle("bad", !verdict.stable);
  find("device").textContent = `${scene.hands.device_words}.`;
  find("limit").textContent = `With this hand and delay an object may have ${verdict.limit}; this one has ${
    scene.hands.object_npmm} N/mm where it is stiffest.`;
}

// A force at the lower limit is an object that does not pull: nothing to be told.
function notes_in_words(notes, force_n) {
  const told = force_n <= scene.entry.min_n ? notes & ~scene.entry.clamped : notes;
  const words = scene.entry.notes.filter(([bit]) => told & bit).map(([, text]) => text);
  if (trace.vibration_mps > VIBRATES_MPS) words.push("vibrates");
  return words.length > 0 ? words.join(", ") : "fine";
}

// After the pictures, and ten times a second: text moves the layout.
function read_tick(now_ms) {
  if (now_ms - read_ms < READ_MS) return;
  read_ms = now_ms;
  const depth = (1e3 * trace.newest_m).toFixed(2), force = trace.newest_n.toFixed(2);
  find("depth").textContent = `${depth} mm`;
  find("force").textContent = `${force} N`;
  find("vibration").textContent = `${(1e3 * trace.vibration_mps).toFixed(1)} mm/s`;
  const words = notes_in_words(trace.newest_notes, trace.newest_n);
  if (words !== spoken && now_ms - spoken_ms > SPOKEN_MS) [spoken, spoken_ms] = [words, now_ms];
  find("notes").textContent = spoken;
  const place = trace.newest_m < 0 ? `${depth.slice(1)} mm above` : `${depth} mm deep`;
  find("object").setAttribute("aria-valuenow", depth);
  find("object").setAttribute("aria-valuetext", `${place}, ${force} N`);
}
