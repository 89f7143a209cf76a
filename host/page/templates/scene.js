// The emitted C as WebAssembly: one scene, its buffers, and what it proves of itself.

const TIMED_TICKS = 10000; // at once: a page's clock has steps of up to 100 us
const TIMED_RUNS = 5;

async function inflated(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

class Scene {
  static async load(entry) {
    const module = await WebAssembly.instantiate(await inflated(entry.wasm), {});
    const scene = new Scene(entry, module.instance.exports);
    const text = async (packed) => new TextDecoder().decode(await inflated(packed));
    scene.hands = JSON.parse(await text(entry.hands));
    scene.tick_c = await text(entry.tick);
    if (entry.recording !== null) {
      scene.recorded_m = new scene.Real(await inflated(entry.recording.position_m));
      const share = new Int16Array(await inflated(entry.recording.measured));
      scene.measured_n = Float64Array.from(share, (x) => (x * entry.recording.scale_n));
    }
    return scene;
  }

  constructor(entry, c) {
    this.entry = entry;
    this.c = c;
    this.Real = entry.number === "float32" ? Float32Array : Float64Array;
    const rows = c.sp_page_rows();
    const view = (Type, at, length) => new Type(c.memory.buffer, at, length);
    this.rows = rows;
    this.intended_m = view(Float64Array, c.sp_page_intended_m(), rows);
    this.position_m = view(this.Real, c.sp_page_position_m(), rows);
    this.velocity_mps = view(this.Real, c.sp_page_velocity_mps(), rows);
    this.force_n = view(this.Real, c.sp_page_force_n(), rows);
    this.notes = view(Int32Array, c.sp_page_notes(), rows);
    this.link = view(Uint8Array, c.sp_page_link(), c.sp_page_link_bytes());
    this.recorded_m = this.measured_n = new Float64Array(0);
  }

  // The recording through the C, from a fresh state; its forces are left in force_n.
  replay() {
    const n = this.recorded_m.length;
    this.position_m.set(this.recorded_m);
    // Backward differences in the scene's own precision, as the replay on the PC makes them.
    const dt_s = new this.Real([this.entry.dt_s])[0];
    const step_m = new this.Real(n);
    for (let i = 1; i < n; i++) step_m[i] = this.recorded_m[i] - this.recorded_m[i - 1];
    for (let i = 0; i < n; i++) this.velocity_mps[i] = step_m[i] / dt_s;
    this.c.sp_page_replay(n);
    return this.force_n.subarray(0, n);
  }

  force_crc(n) {
    return (this.c.sp_page_force_crc(n) >>> 0).toString(16).padStart(8, "0");
  }

  // Ticks of a press, timed at once; us a tick, the least of a few: a browser compiles well late.
  tick_us() {
    const peak_m = this.entry.depth_m;
    for (let i = 0; i < TIMED_TICKS; i++)
      this.position_m[i] = (peak_m * (1 - Math.cos((2 * Math.PI * i) / 1000))) / 2;
    this.velocity_mps.fill(0);
    let least_ms = Infinity;
    for (let run = 0; run < TIMED_RUNS; run++) {
      const began_ms = performance.now();
      this.c.sp_page_replay(TIMED_TICKS);
      least_ms = Math.min(least_ms, performance.now() - began_ms);
    }
    return (1e3 * least_ms) / TIMED_TICKS;
  }
}
