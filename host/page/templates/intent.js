// Where the hand intends to be: points in time from pointer, finger or keys, even in between.

const LET_GO_MS = 150;
const EVEN_MS = 25; // an event's place is reached so much later: the next one is mostly known then
const KEY_RANGE_S = 0.8; // an arrow key goes through the whole range in this time

class Intent {
  constructor(free_m, deepest_m) {
    this.free_m = free_m;
    this.deepest_m = deepest_m;
    this.now_m = free_m;
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
      const to_ms = this.at_ms + dt_ms;
      if (this.key !== 0) {
        const range_m = this.deepest_m - this.free_m;
        this.now_m = this.limited(this.now_m + (this.key * range_m * dt_ms) / (1e3 * KEY_RANGE_S));
      }
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
