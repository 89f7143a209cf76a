// Runs a page's module in node: node check.mjs MODULE PREFIX float32|float64 < MOTION > RESULT
// MOTION: positions, then velocities. RESULT: answer of the self-test, int32, then the forces.
import { readFileSync, writeFileSync } from "node:fs";

const [file, prefix, number] = process.argv.slice(2);
const { exports: c } = new WebAssembly.Instance(new WebAssembly.Module(readFileSync(file)));
const scene = (name, ...words) => c[`${prefix}_${name}`](...words);
const given = readFileSync(0);
const Real = number === "float32" ? Float32Array : Float64Array;
const half = given.byteLength / 2, ticks = half / Real.BYTES_PER_ELEMENT;
const state = Math.ceil(c.__heap_base.value / 16) * 16;
c.memory.grow(1 + Math.ceil(scene("state_size") / 65536));
const bytes = (array, size) => new Uint8Array(c.memory.buffer, array.value, size);
bytes(c.sp_page_position_m, half).set(given.subarray(0, half));
bytes(c.sp_page_velocity_mps, half).set(given.subarray(half));
scene("init", state);
scene("run", state, ticks, c.sp_page_position_m.value, c.sp_page_velocity_mps.value, c.sp_page_force_n.value);
const answer = Buffer.alloc(4);
answer.writeInt32LE(scene("selftest"));
writeFileSync(1, Buffer.concat([answer, bytes(c.sp_page_force_n, half)]));
