// The map from above: stiffness in colours, the tool, the force sideways, and what was found.

const SIDE = 38, LEGEND = 34, EDGE = 12; // pixels around the map
const SIDEWAYS = 56, LEAST_MOST_N = 0.25; // the longest arrow, pixels; it stands for this, at least
const WHISKER_M = 7e-4; // between arrows of the trail

class MapView {
  constructor(canvas, map) {
    this.canvas = canvas;
    this.map = map;
    this.stiffness = new StiffnessPicture(map);
    this.turned = [false, false]; // along x, along y
    this.seen = map.entry; // first_m, last_m: of the part that is shown
    const [wide_m, high_m] = this.spans_m;
    canvas.style.aspectRatio = Math.min(1.6, Math.max(0.7, wide_m / high_m));
    const { width, height } = canvas.getBoundingClientRect();
    this.fit(width, height); // a pointer may come before the first picture
  }

  get spans_m() {
    const { first_m, last_m } = this.seen;
    return first_m.map((its_m, k) => last_m[k] - its_m);
  }

  fit(width, height) {
    const [wide_m, high_m] = this.spans_m, more = 1 + 2 * MARGIN;
    const across = width - SIDE - EDGE, up = height - LEGEND - SIDE;
    this.per_m = Math.min(across / (more * wide_m), up / (more * high_m));
    const [wide, high] = [wide_m * this.per_m, high_m * this.per_m];
    this.box = { left: SIDE + (across - wide) / 2, top: LEGEND + (up - high) / 2, width: wide, height: high };
  }

  pixels(place_m) {
    const { first_m, last_m } = this.seen, { box } = this, [right_m, up_m] = this.shown_m(place_m);
    return [box.left + (right_m - first_m[0]) * this.per_m, box.top + (last_m[1] - up_m) * this.per_m];
  }

  // The place under a point of the canvas.
  place_at(x, y) {
    const { first_m, last_m } = this.seen, { box } = this;
    return this.shown_m([first_m[0] + (x - box.left) / this.per_m, last_m[1] - (y - box.top) / this.per_m]);
  }

  // A place as the picture shows it: on a map that is turned, its mirror image.
  shown_m(place_m) {
    const { first_m, last_m } = this.seen;
    return place_m.map((its_m, k) => (this.turned[k] ? first_m[k] + last_m[k] - its_m : its_m));
  }

  // Show the whole map, 1, or a part of it in which the stiffest place lies, somewhere.
  show_part(part) {
    const { first_m, last_m } = this.map.entry, { stiffest_m } = this.map;
    const begins_m = first_m.map((its_m, k) => {
      const whole_m = last_m[k] - its_m, span_m = part * whole_m, edge_m = MARGIN * span_m;
      const least_m = Math.max(its_m, stiffest_m[k] + edge_m - span_m);
      const most_m = Math.min(last_m[k] - span_m, stiffest_m[k] - edge_m);
      return Math.max(its_m, Math.min(last_m[k] - span_m, least_m + Math.random() * (most_m - least_m)));
    });
    const ends_m = begins_m.map((its_m, k) => its_m + part * (last_m[k] - first_m[k]));
    this.seen = part < 1 ? { first_m: begins_m, last_m: ends_m } : this.map.entry;
  }

  get middle_m() {
    return this.seen.first_m.map((its_m, k) => (its_m + this.seen.last_m[k]) / 2);
  }

  // The nearest place that a hand reaches: on what is shown, or a little beside it.
  within(place_m) {
    const { first_m, last_m } = this.seen;
    return place_m.map((its_m, k) => {
      const margin_m = MARGIN * (last_m[k] - first_m[k]);
      return Math.min(last_m[k] + margin_m, Math.max(first_m[k] - margin_m, its_m));
    });
  }

  // A step on the screen, right and up, as one on the object.
  step_m(step_m) {
    return step_m.map((its_m, k) => (this.turned[k] ? -its_m : its_m));
  }

  draw(found) {
    const { context, width, height } = cleared(this.canvas);
    this.fit(width, height);
    const { box } = this;
    context.fillStyle = colour("--object");
    context.fillRect(box.left, box.top, box.width, box.height);
    if (found.colours) {
      this.stiffness.draw(context, box);
      this.stiffness.legend(context, width);
      this.axes(context, height);
    }
    this.trail(context);
    if (found.marks_m.length > 0) this.marks(context, found.marks_m);
    else if (found.searches && this.map.touched_m !== null && !this.map.touches)
      this.ring(context, this.map.touched_m, 5, "--ink");
    this.hand(context);
  }

  axes(context, height) {
    const { first_m, last_m } = this.seen, { box } = this;
    context.fillStyle = colour("--muted");
    context.textBaseline = "middle";
    const ticks = (k) => {
      const step_m = tick_step(last_m[k] - first_m[k]), found = [];
      for (let at = Math.ceil(first_m[k] / step_m - 1e-9); at * step_m <= last_m[k] + 1e-9; at++) found.push(at * step_m);
      return found;
    };
    const words = (its_m) => String(Number((1e3 * its_m).toPrecision(4)));
    context.textAlign = "center";
    for (const x_m of ticks(0)) context.fillText(words(x_m), this.pixels([x_m, first_m[1]])[0], box.top + box.height + 12);
    context.fillText("x, mm", box.left + box.width / 2, Math.min(height - 7, box.top + box.height + 27));
    context.textAlign = "right";
    for (const y_m of ticks(1)) context.fillText(words(y_m), box.left - 6, this.pixels([first_m[0], y_m])[1]);
    context.textAlign = "left";
    context.fillText("y, mm", 0, Math.max(LEGEND + 2, box.top - 8));
  }

  trail(context) {
    const { trail, slides } = this.map;
    context.lineWidth = 2;
    context.strokeStyle = colour("--ghost");
    context.beginPath();
    let pen = false;
    for (const { at_m, touches } of trail) {
      if (touches && pen) context.lineTo(...this.pixels(at_m));
      else context.moveTo(...this.pixels(at_m));
      pen = touches;
    }
    context.stroke();
    let before_m = null;
    for (const { at_m, force_n, touches } of slides ? trail : []) {
      if (!touches || (before_m !== null && way_m(before_m, at_m) < WHISKER_M)) continue;
      before_m = at_m;
      this.sideways(context, at_m, force_n, 1.5, 0);
    }
  }

  // The force on the tool along x and y, from a place on.
  sideways(context, at_m, force_n, wide, head) {
    const [x, y] = this.pixels(at_m), [right_n, up_n] = this.step_m(force_n);
    const scale = SIDEWAYS / Math.max(LEAST_MOST_N, this.map.most_n);
    const [dx, dy] = [right_n * scale, -up_n * scale], length = Math.hypot(dx, dy);
    if (length < 1) return;
    for (const [tint, more] of [["--paper", 2], ["--force", 0]]) {
      context.strokeStyle = colour(tint);
      context.lineWidth = wide + more;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + dx, y + dy);
      for (const side of head > 0 ? [-2.6, 2.6] : []) {
        const angle = Math.atan2(dy, dx) + side;
        context.moveTo(x + dx, y + dy);
        context.lineTo(x + dx + head * Math.cos(angle), y + dy + head * Math.sin(angle));
      }
      context.stroke();
    }
  }

  ring(context, at_m, radius, tint, fill = null) {
    const [x, y] = this.pixels(at_m);
    context.beginPath();
    context.arc(x, y, radius, 0, 7);
    if (fill !== null) {
      context.fillStyle = colour(fill);
      context.fill();
    }
    for (const [its, wide] of [["--paper", 4], [tint, 2]]) {
      context.strokeStyle = colour(its);
      context.lineWidth = wide;
      context.stroke();
    }
  }

  hand(context) {
    const { map } = this, [x, y] = this.pixels(map.at_m), to_m = map.place.to_m;
    if (way_m(map.at_m, to_m) > 2e-4) {
      context.setLineDash([3, 4]);
      context.strokeStyle = colour("--ghost");
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(...this.pixels(to_m));
      context.arc(...this.pixels(to_m), 7, 0, 7);
      context.stroke();
      context.setLineDash([]);
    }
    this.ring(context, map.at_m, 8, "--ink", map.touches ? "--finger" : null);
    if (map.touches && map.slides) this.sideways(context, map.at_m, map.force_n, 3.5, 8);
  }

  // Where the person says that it is stiffest, and where it is.
  marks(context, marks_m) {
    const [x, y] = this.pixels(this.map.stiffest_m);
    for (const [tint, wide] of [["--paper", 6], ["--force", 3]]) {
      context.strokeStyle = colour(tint);
      context.lineWidth = wide;
      context.beginPath();
      for (const mark_m of marks_m) {
        context.moveTo(...this.pixels(mark_m));
        context.lineTo(x, y);
      }
      for (const [dx, dy] of [[9, 9], [9, -9]]) {
        context.moveTo(x - dx, y - dy);
        context.lineTo(x + dx, y + dy);
      }
      context.stroke();
    }
    for (const mark_m of marks_m) this.ring(context, mark_m, 6, "--force", "--paper");
  }
}
