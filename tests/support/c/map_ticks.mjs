// Ticks of a map's wasm module: node map_ticks.mjs MODULE float32|float64 step|step3 CALLS RETURNS
// CALLS: rows of x, y, depth and velocity. step: sp_place where x or y is another one than in the
// row before, then sp_step. RETURNS: forces, one a row or three, then the notes as 32-bit integers.
import { readFileSync, writeFileSync } from "node:fs";

const [module, number, call, calls, returns] = process.argv.slice(2);
const { exports: c } = new WebAssembly.Instance(new WebAssembly.Module(readFileSync(module)), {});
const Real = number === "float32" ? Float32Array : Float64Array;
const bytes = readFileSync(calls);
const rows = new Real(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
const state = c.__heap_base.value + 64 - (c.__heap_base.value % 64);
const at = state + 64 * Math.ceil(c.sp_state_size() / 64);
c.memory.grow(1);
const input = new Real(c.memory.buffer, at, 3), output = new Real(c.memory.buffer, at + 64, 3);

const axes = call === "step3" ? 3 : 1, n = rows.length / 4;
const forces = new Real(axes * n), notes = new Int32Array(n);
c.sp_init(state);
for (let i = 0; i < n; i++) {
  const [x, y, depth, velocity] = rows.subarray(4 * i, 4 * i + 4);
  input.set([x, y, depth]);
  if (axes === 3) notes[i] = c.sp_step3(state, at, 0, at + 64);
  else {
    if (i === 0 || x !== rows[4 * i - 4] || y !== rows[4 * i - 3]) c.sp_place(state, x, y);
    notes[i] = c.sp_step(state, depth, velocity, at + 64);
  }
  forces.set(output.subarray(0, axes), axes * i);
}
writeFileSync(returns, Buffer.concat([new Uint8Array(forces.buffer), new Uint8Array(notes.buffer)]));
console.log(c.sp_selftest());
