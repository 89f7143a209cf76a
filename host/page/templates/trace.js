// What came of every tick: the last seconds for the pictures, and all since the start for the file.

const SHOWN_S = 4;
const KEPT_S = 120;
const QUIET_HZ = 15; // vibration is what is above

class Trace {
  constructor(dt_s, Real) {
    this.dt_s = dt_s;
    const shown = Math.round(SHOWN_S / dt_s);
    this.depth_m = new Float64Array(shown);
    this.force_n = new Float64Array(shown);
    this.length = shown;
    this.count = 0; // of rows that came
    this.kept_m = new Real(Math.round(KEPT_S / dt_s));
    this.kept_n = new Real(this.kept_m.length);
    this.smoothing = 1 / (1 + 1 / (2 * Math.PI * QUIET_HZ * dt_s));
    this.low_mps = this.lower_mps = this.power = 0;
    this.most_m = this.most_n = 0;
    this.frame = { low_m: 0, high_m: 0 };
  }

  get full() {
    return this.count >= this.kept_m.length;
  }

  take(position_m, force_n, rows, notes) {
    let low_m = Infinity, high_m = -Infinity;
    for (let i = 0; i < rows; i++) {
      const here_m = position_m[i], before_m = this.newest_m ?? here_m;
      const at = this.count % this.length;
      this.depth_m[at] = here_m;
      this.force_n[at] = force_n[i];
      if (!this.full) {
        this.kept_m[this.count] = here_m;
        this.kept_n[this.count] = force_n[i];
      }
      this.most_m = Math.max(this.most_m, here_m);
      this.most_n = Math.max(this.most_n, force_n[i]);
      low_m = Math.min(low_m, here_m);
      high_m = Math.max(high_m, here_m);
      this.vibrate((here_m - before_m) / this.dt_s);
      this.newest_m = here_m;
      this.newest_n = force_n[i];
      this.count++;
    }
    this.newest_notes = notes[rows - 1];
    if (rows > 0) this.frame = { low_m, high_m };
  }

  // A high-pass of second order and the mean square of a quarter of a second.
  vibrate(speed_mps) {
    this.low_mps += this.smoothing * (speed_mps - this.low_mps);
    const high_mps = speed_mps - this.low_mps;
    this.lower_mps += this.smoothing * (high_mps - this.lower_mps);
    const found = high_mps - this.lower_mps;
    this.power += (this.dt_s / 0.25) * (found * found - this.power);
  }

  get vibration_mps() {
    return Math.sqrt(this.power);
  }

  // Depth and force of the last seconds, thinned.
  loop() {
    const shown = Math.min(this.count, this.length), stride = Math.max(1, Math.floor(shown / 600));
    const points = [];
    for (let i = this.count - shown; i < this.count; i += stride)
      points.push([this.depth_m[i % this.length], this.force_n[i % this.length]]);
    return points;
  }

  csv() {
    const n = Math.min(this.count, this.kept_m.length), lines = ["time_s,position_m,force_N"];
    for (let i = 0; i < n; i++)
      lines.push(`${Number((i * this.dt_s).toPrecision(12))},${this.kept_m[i]},${this.kept_n[i]}`);
    return lines.join("\n") + "\n";
  }
}
