// A page's survey of a map: node map_survey.mjs MODULE COLUMNS ROWS X0 Y0 X1 Y1 DEPTH TICKS DT
// Prints the forces, N, row after row.
import { readFileSync } from "node:fs";

const [module, ...given] = process.argv.slice(2), numbers = given.map(Number);
const { exports: c } = new WebAssembly.Instance(new WebAssembly.Module(readFileSync(module)), {});
const [columns, rows] = numbers, [depth_m, ticks, dt_s] = numbers.slice(6);
new Float64Array(c.memory.buffer, c.sp_page_survey_ends_m(), 4).set(numbers.slice(2, 6));
const at = c.sp_page_survey(columns, rows, depth_m, ticks, dt_s);
console.log(JSON.stringify([...new Float64Array(c.memory.buffer, at, columns * rows)]));
