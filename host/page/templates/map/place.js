// Where the hand intends to be over the map: an intent along x and one along y.

const MARGIN = 0.06; // of the map's extent, beyond which the hand does not go

class Place {
  constructor({ first_m, last_m }, at_m) {
    this.axes = [0, 1].map((k) => {
      const margin_m = MARGIN * (last_m[k] - first_m[k]);
      const axis = new Intent(first_m[k] - margin_m, last_m[k] + margin_m);
      axis.now_m = at_m[k];
      return axis;
    });
  }

  go(time_ms, to_m) {
    this.axes.forEach((axis, k) => axis.add(time_ms, to_m[k]));
  }

  get to_m() {
    return this.axes.map((axis) => axis.points.at(-1)?.[1] ?? axis.now_m);
  }

  // Of ticks that end dt_ms apart from at_ms on.
  fill(buffers, ticks, at_ms, dt_ms) {
    this.axes.forEach((axis, k) => {
      axis.at_ms = at_ms;
      axis.fill(buffers[k], ticks, dt_ms);
    });
  }
}
