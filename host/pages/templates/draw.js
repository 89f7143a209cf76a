// The pictures: the object in section under a fingertip, depth and force of the last seconds.

const SURFACE = 0.32, TRAINED = 0.3; // of the picture's height: the surface, the trained depth
const TIP = 0.085; // of its width, half of the fingertip
const LEFT = 44, TOP = 18;

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// The context, in CSS pixels, cleared; and its size.
function cleared(canvas) {
  const { width, height } = canvas.getBoundingClientRect(), ratio = devicePixelRatio || 1;
  const wide = Math.round(width * ratio), high = Math.round(height * ratio);
  if (canvas.width !== wide || canvas.height !== high) [canvas.width, canvas.height] = [wide, high];
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = "12px system-ui, sans-serif";
  context.lineJoin = "round";
  return { context, width, height };
}

function line(context, points, tint, wide = 1, dashes = []) {
  context.strokeStyle = tint;
  context.lineWidth = wide;
  context.setLineDash(dashes);
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  context.stroke();
  context.setLineDash([]);
}

function write(context, text, x, y, align, baseline = "middle") {
  context.textAlign = align;
  context.textBaseline = baseline;
  context.fillText(text, x, y);
}

// A step of 1, 2 or 5 that parts the range into two to five.
function tick_step(range) {
  const rough = range / 4, decade = 10 ** Math.floor(Math.log10(rough));
  return decade * [1, 2, 5, 10].find((factor) => factor * decade >= rough);
}

// A panel of a plot: lines at round values, and their numbers on its left; returns y of a value.
function panel(context, box, low, high, unit) {
  const y = (value) => box.top + ((high - value) / (high - low)) * box.height;
  const step = tick_step(high - low);
  context.fillStyle = colour("--muted");
  for (let value = Math.ceil(low / step) * step; value <= high + 1e-9; value += step) {
    line(context, [[box.left, y(value)], [box.left + box.width, y(value)]], colour("--line"));
    write(context, String(Number(value.toPrecision(6))), box.left - 6, y(value), "right");
  }
  write(context, unit, box.left, box.top - 15, "left", "top");
  return y;
}

class Pictures {
  // sizes: the greatest of all scenes of the page, so that they can be compared.
  constructor(sizes) {
    this.sizes = sizes;
    [this.object, this.scope, this.loop] = ["object", "scope", "loop"].map((id) => document.getElementById(id));
  }

  get m_per_pixel() {
    return this.sizes.depth_m / (TRAINED * this.object.getBoundingClientRect().height);
  }

  // The intent that a place in the picture means. Below the surface it is stretched: the bottom
  // is deep enough for this hand to reach the greatest force.
  intent_at(y, intent) {
    const { height } = this.object.getBoundingClientRect(), below = y - SURFACE * height;
    return below <= 0 ? below * this.m_per_pixel : (below / ((0.97 - SURFACE) * height)) * intent.deepest_m;
  }

  y_of_intent(intent, height) {
    if (intent.now_m <= 0) return SURFACE * height + intent.now_m / this.m_per_pixel;
    return (SURFACE + ((0.97 - SURFACE) * intent.now_m) / intent.deepest_m) * height;
  }

  draw(scene, trace, intent) {
    this.draw_object(trace, intent);
    this.draw_scope(trace);
    this.draw_loop(scene, trace);
  }

  draw_object({ now }, intent) {
    const { context, width, height } = cleared(this.object);
    const surface = SURFACE * height, middle = width / 2, tip = TIP * width, m_per_pixel = this.m_per_pixel;
    const end = surface + now.depth_m / m_per_pixel, ghost = this.y_of_intent(intent, height);
    this.draw_body(context, width, height, tip, Math.max(0, end - surface));
    this.draw_finger(context, middle, ghost, tip, null);
    line(context, [[middle, end], [middle, ghost]], colour("--ghost"), 1.5, [3, 4]);
    this.draw_finger(context, middle, end, tip, colour("--finger"));
    this.draw_arrow(context, middle + 1.9 * tip, surface, now.force_n, height);
    context.fillStyle = colour("--scale");
    for (let depth_m = 0; depth_m <= 1.31 * this.sizes.depth_m; depth_m += tick_step(this.sizes.depth_m)) {
      const y = surface + depth_m / m_per_pixel;
      line(context, [[width - 8, y], [width, y]], colour("--scale"));
      write(context, `${Number((1e3 * depth_m).toPrecision(4))} mm`, width - 12, y - 7, "right");
    }
  }

  // A flat punch of radius `tip` on an elastic half-space sinks the layers below it like this.
  draw_body(context, width, height, tip, depth) {
    const surface = SURFACE * height, layer = (z) => {
      const points = [];
      for (let x = 0; x < width + 6; x += 6) {
        const r = Math.abs(x - width / 2), reach = Math.hypot(r - tip, z) + Math.hypot(r + tip, z);
        points.push([x, surface + z + depth * (2 / Math.PI) * Math.asin(Math.min(1, (2 * tip) / reach))]);
      }
      return points;
    };
    context.fillStyle = colour("--object");
    context.beginPath();
    for (const [x, y] of [[0, height], ...layer(0), [width, height]]) context.lineTo(x, y);
    context.fill();
    const step_m = tick_step(this.sizes.depth_m) / 2, pixels = step_m / this.m_per_pixel;
    for (let z = pixels; z < height - surface; z += pixels) line(context, layer(z), colour("--layer"));
  }

  // Its lower end is at y; a ghost is an outline.
  draw_finger(context, x, y, half, fill) {
    context.beginPath();
    context.roundRect(x - half, -20, 2 * half, Math.max(0, y + 20), [0, 0, 0.2 * half, 0.2 * half]);
    context.fillStyle = fill;
    context.strokeStyle = colour("--ghost");
    context.setLineDash([5, 4]);
    if (fill === null) context.stroke();
    else context.fill();
    context.setLineDash([]);
  }

  draw_arrow(context, x, y, force_n, height) {
    const length = (Math.abs(force_n) / this.sizes.max_n) * SURFACE * 0.8 * height, up = force_n > 0 ? -1 : 1;
    if (length < 2) return;
    context.fillStyle = colour("--force");
    line(context, [[x, y], [x, y + up * Math.max(0, length - 8)]], colour("--force"), 4);
    context.beginPath();
    for (const [dx, dy] of [[0, length], [-7, length - 12], [7, length - 12]]) context.lineTo(x + dx, y + up * dy);
    context.fill();
    write(context, `${force_n.toFixed(2)} N`, x + 12, y + (up * length) / 2, "left");
  }

  draw_scope(trace) {
    const { context, width, height } = cleared(this.scope), { sizes } = this;
    const gap = TOP + 6, high = (height - TOP - gap - 14) / 2;
    const curves = [
      [TOP, "depth, mm", 1e3 * sizes.free_m, 1.3e3 * sizes.depth_m, trace.depth_m, 1e3, colour("--depth")],
      [TOP + high + gap, "force, N", sizes.min_n, 1.1 * sizes.max_n, trace.force_n, 1, colour("--force")],
    ];
    for (const [top, unit, low, most, values, factor, tint] of curves) {
      const box = { left: LEFT, top, width: width - LEFT, height: high };
      const y = panel(context, box, low, most, unit), points = [];
      // From the least to the greatest of each column of pixels.
      for (let column = 0; column < box.width; column++) {
        const from = trace.count - Math.floor((1 - column / box.width) * trace.shown);
        if (from < 0 || from >= trace.count) continue;
        const part = values.subarray(from, Math.min(trace.count, from + Math.ceil(trace.shown / box.width)));
        for (const value of [Math.min(...part), Math.max(...part)]) points.push([LEFT + column, y(factor * value)]);
      }
      line(context, points, tint, 2);
    }
    context.fillStyle = colour("--muted");
    write(context, `${SHOWN_S} s`, width, height, "right", "bottom");
  }

  draw_loop(scene, trace) {
    const { context, width, height } = cleared(this.loop), { sizes } = this, most_m = 1.3 * sizes.depth_m;
    const box = { left: LEFT, top: TOP, width: width - LEFT, height: height - TOP - 22 };
    const y = panel(context, box, sizes.min_n, 1.1 * sizes.max_n, "force, N, against depth");
    const x = (depth_m) => LEFT + ((depth_m - sizes.free_m) / (most_m - sizes.free_m)) * box.width;
    for (let depth_m = 0; x(depth_m) < width - 90; depth_m += tick_step(most_m))
      write(context, `${Number((1e3 * depth_m).toPrecision(4))}`, x(depth_m), height - 18, "center", "top");
    write(context, "depth, mm", width, height - 18, "right", "top");
    const curve = (depth_m, force_n, from, to, tint, wide) => {
      const points = [], stride = Math.max(1, Math.ceil((to - from) / 3000));
      for (let i = from; i < to; i += stride) points.push([Math.max(LEFT, x(depth_m[i])), y(force_n[i])]);
      line(context, points, tint, wide);
    };
    const [depth_m, force_n] = scene.recording;
    if (depth_m !== undefined) curve(depth_m, force_n, 0, depth_m.length, colour("--faint"), 1);
    curve(trace.depth_m, trace.force_n, trace.first, trace.count, colour("--force"), 2);
    context.fillStyle = colour("--force");
    context.beginPath();
    context.arc(x(trace.now.depth_m), y(trace.now.force_n), 5, 0, 7);
    context.fill();
  }
}
