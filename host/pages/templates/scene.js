// The emitted C as WebAssembly under a simulated hand, what the hand intends, and what came of it.

const ROWS = 16384; // SP_PAGE_ROWS of sp_page.h
const SHOWN_S = 4;
const KEPT_S = 120;
const EVEN_MS = 25; // an event's place is reached so much later: the next one is mostly known then
const LET_GO_MS = 150;
const KEY_RANGE_S = 0.8; // an arrow key goes through the whole range in this time
const MAX_GAP_MS = 100; // a page in the background has no frames: what it missed is left out

async function inflated(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

class Scene {
  static async load(entry) {
    const module = await WebAssembly.instantiate(await inflated(entry.wasm), {});
    const scene = new Scene(entry, module.instance.exports);
    for (const packed of entry.recording ?? []) scene.recording.push(new Float32Array(await inflated(packed)));
    return scene;
  }

  constructor(entry, c) {
    this.entry = entry;
    this.c = c;
    this.recording = []; // depth_m and force_n, or nothing
    this.Real = entry.number === "float32" ? Float32Array : Float64Array;
    const view = (Type, name) => new Type(c.memory.buffer, c[`sp_page_${name}`].value, ROWS);
    this.intended_m = view(Float64Array, "intended_m");
    this.position_m = view(this.Real, "position_m");
    this.velocity_mps = view(this.Real, "velocity_mps");
    this.force_n = view(this.Real, "force_n");
    this.notes = view(Int32Array, "notes");
    c.sp_page_set_device(...entry.device);
  }

  // The self-test in words.
  proof() {
    const wrong = this.c[`${this.entry.prefix}_selftest`]();
    return wrong === 0 ? "no step differs from the reference"
      : `step ${wrong - 1} differs from the reference: do not trust this page`;
  }

  hold(stiffness_npm, added_delay) {
    const [mass_kg, damping_nspm] = this.entry.hand;
    this.c.sp_page_set_hand(mass_kg, stiffness_npm, damping_nspm, this.entry.own_delay + added_delay);
  }

  start() {
    this.c.sp_page_start(this.entry.free_m);
    this.rendered_ms = null;
    this.owed = 0; // ticks, less than one
  }

  // Ticks up to now; returns how many.
  advance(now_ms, intent) {
    const dt_ms = 1e3 * this.entry.dt_s;
    this.owed += Math.min(MAX_GAP_MS, now_ms - (this.rendered_ms ?? now_ms)) / dt_ms;
    this.rendered_ms = now_ms;
    const ticks = Math.min(ROWS, Math.floor(this.owed));
    this.owed -= ticks;
    intent.at_ms = now_ms - (ticks + this.owed) * dt_ms;
    intent.fill(this.intended_m, ticks, dt_ms);
    this.c.sp_page_run(ticks, this.entry.dt_s);
    return ticks;
  }
}

// Where the hand intends to be: points in time from pointer, finger or keys, even in between.
class Intent {
  constructor(free_m) {
    this.free_m = this.deepest_m = this.now_m = free_m;
    this.at_ms = 0;
    this.points = []; // [time_ms, m], later than at_ms
    this.key = 0; // 1 deeper, -1 out
  }

  limited(to_m) {
    return Math.min(this.deepest_m, Math.max(this.free_m, to_m));
  }

  add(time_ms, to_m) {
    this.points.push([Math.max(time_ms + EVEN_MS, this.at_ms), this.limited(to_m)]);
  }

  let_go(time_ms) {
    this.key = 0;
    this.points = [[Math.max(time_ms, this.at_ms) + LET_GO_MS, this.free_m]];
  }

  // Intents of ticks that end dt_ms apart from at_ms on.
  fill(intended_m, ticks, dt_ms) {
    for (let i = 0; i < ticks; i++) {
      const to_ms = this.at_ms + dt_ms, range_m = this.deepest_m - this.free_m;
      if (this.key !== 0) this.now_m = this.limited(this.now_m + (this.key * range_m * dt_ms) / (1e3 * KEY_RANGE_S));
      while (this.points.length > 0 && this.points[0][0] <= to_ms) this.now_m = this.points.shift()[1];
      if (this.points.length > 0) {
        const [until_ms, there_m] = this.points[0];
        this.now_m += ((there_m - this.now_m) * dt_ms) / Math.max(dt_ms, until_ms - this.at_ms);
      }
      this.at_ms = to_ms;
      intended_m[i] = this.now_m;
    }
  }
}

// Every tick since the start, KEPT_S at most.
class Trace {
  constructor(scene) {
    const { dt_s } = scene.entry, kept = Math.round(KEPT_S / dt_s);
    this.dt_s = dt_s;
    this.count = 0; // of ticks that are kept
    this.shown = Math.round(SHOWN_S / dt_s);
    this.depth_m = new scene.Real(kept);
    this.velocity_mps = new scene.Real(kept);
    this.force_n = new scene.Real(kept);
    this.now = { depth_m: scene.entry.free_m, force_n: 0, notes: 0 };
  }

  take(scene, ticks) {
    if (ticks === 0) return;
    const at = ticks - 1, rows = Math.min(ticks, this.depth_m.length - this.count);
    this.depth_m.set(scene.position_m.subarray(0, rows), this.count);
    this.velocity_mps.set(scene.velocity_mps.subarray(0, rows), this.count);
    this.force_n.set(scene.force_n.subarray(0, rows), this.count);
    this.count += rows;
    this.now = { depth_m: scene.position_m[at], force_n: scene.force_n[at], notes: scene.notes[at] };
  }

  get first() {
    return Math.max(0, this.count - this.shown);
  }

  csv() {
    const lines = ["time_s,position_m,velocity_mps,force_N"];
    for (let i = 0; i < this.count; i++)
      lines.push([Number((i * this.dt_s).toPrecision(12)), this.depth_m[i], this.velocity_mps[i], this.force_n[i]].join());
    return lines.join("\n") + "\n";
  }
}
