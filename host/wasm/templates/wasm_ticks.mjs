// Ticks of a scene's wasm module: node wasm_ticks.mjs MODULE PREFIX float32|float64 CALLS RETURNS
// CALLS: positions, then velocities. RETURNS: forces, then the notes as 32-bit integers.
// Prints what the self-test returned and the time of a tick, ns, of all ticks at once.
import { readFileSync, writeFileSync } from "node:fs";

// All ticks again and again for so long, and the lowest time of them: the engine compiles what runs
// often a second time, better, and other programs use the processor too.
const TIMED_MS = 100;
const PAGE = 65536; // bytes, of wasm's memory

const [module, prefix, number, calls, returns] = process.argv.slice(2);
const { exports: c } = new WebAssembly.Instance(new WebAssembly.Module(readFileSync(module)), {});
const scene = (name) => c[`${prefix}_${name}`];
const Real = number === "float32" ? Float32Array : Float64Array;
const given = readFileSync(calls);
const n = given.byteLength / (2 * Real.BYTES_PER_ELEMENT);

let end = c.__heap_base.value;
function take(bytes) {
  const at = Math.ceil(end / 16) * 16;
  end = at + bytes;
  const lacking = Math.ceil((end - c.memory.buffer.byteLength) / PAGE);
  if (lacking > 0) c.memory.grow(lacking);
  return at;
}
const state = take(scene("state_size")());
const input = take(given.byteLength);
const output = take(n * Real.BYTES_PER_ELEMENT);
new Uint8Array(c.memory.buffer).set(given, input);
const velocity = input + n * Real.BYTES_PER_ELEMENT;
const positions = new Real(c.memory.buffer, input, n);
const velocities = new Real(c.memory.buffer, velocity, n);
const forces = new Real(c.memory.buffer, output, n);

let least_ms = Infinity;
const until = performance.now() + TIMED_MS;
while (performance.now() < until) {
  scene("init")(state);
  const begin = performance.now();
  scene("run")(state, n, input, velocity, output);
  least_ms = Math.min(least_ms, performance.now() - begin);
}

const notes = new Int32Array(n);
scene("init")(state);
for (let i = 0; i < n; i++) {
  notes[i] = scene("step")(state, positions[i], velocities[i], output + i * Real.BYTES_PER_ELEMENT);
}
const force_bytes = new Uint8Array(forces.buffer, output, forces.byteLength);
writeFileSync(returns, Buffer.concat([force_bytes, new Uint8Array(notes.buffer)]));
console.log(JSON.stringify({ selftest: scene("selftest")(), tick_ns: (1e6 * least_ms) / n }));
