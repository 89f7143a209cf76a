// The object in section under a fingertip, and the hand's intent as a ghost.

const SURFACE = 0.32, TRAINED = 0.3; // of the picture's height: the surface, the trained depth
const TIP = 0.085; // of its width, half of the fingertip

class ObjectView {
  // scale: the largest of all objects of the page, so that they can be compared.
  constructor(canvas, entry, scale) {
    this.canvas = canvas;
    this.entry = entry;
    this.scale = scale;
    this.height = canvas.getBoundingClientRect().height;
  }

  get m_per_pixel() {
    return this.scale.depth_m / (TRAINED * this.height);
  }

  // The intent that a place in the picture means. Below the surface it is stretched: the bottom
  // is deep enough for this hand to reach the greatest force.
  intent_at(y, intent) {
    const below = y - SURFACE * this.height;
    if (below <= 0) return below * this.m_per_pixel;
    return (below / ((0.97 - SURFACE) * this.height)) * intent.deepest_m;
  }

  y_of_intent(intent_m, intent, height) {
    if (intent_m <= 0) return SURFACE * height + intent_m / this.m_per_pixel;
    return (SURFACE + ((0.97 - SURFACE) * intent_m) / intent.deepest_m) * height;
  }

  // intent: null where the hand is a real one, elsewhere.
  draw(trace, intent) {
    const { context, width, height } = cleared(this.canvas);
    this.height = height;
    const surface = SURFACE * height, middle = width / 2, tip = TIP * width;
    const pixels = (m) => m / this.m_per_pixel;
    const depth_m = trace.newest_m ?? this.entry.free_m;
    this.body(context, width, height, surface, middle, tip, pixels(Math.max(0, depth_m)));
    if (intent !== null) {
      const ghost = this.y_of_intent(intent.now_m, intent, height);
      this.finger(context, middle, ghost, tip, null);
      context.setLineDash([3, 4]);
      context.beginPath();
      context.moveTo(middle, surface + pixels(depth_m));
      context.lineTo(middle, ghost);
      context.stroke();
      context.setLineDash([]);
    }
    const { low_m, high_m } = trace.frame;
    if (pixels(high_m - low_m) > 1.5) { // it moved within the frame: all places at once
      context.globalAlpha = 0.35;
      this.finger(context, middle, surface + pixels(low_m), tip, colour("--finger"));
      this.finger(context, middle, surface + pixels(high_m), tip, colour("--finger"));
      context.globalAlpha = 1;
    }
    this.finger(context, middle, surface + pixels(depth_m), tip, colour("--finger"));
    this.arrow(context, middle + 1.9 * tip, surface, trace.newest_n ?? 0, this.scale.max_n, height);
    this.depths(context, width, surface, pixels);
  }

  // A flat punch of radius `tip` on an elastic half-space sinks the layers below it like this.
  sunk(r, z, tip, depth) {
    const reach = Math.hypot(r - tip, z) + Math.hypot(r + tip, z);
    return depth * (2 / Math.PI) * Math.asin(Math.min(1, (2 * tip) / reach));
  }

  body(context, width, height, surface, middle, tip, depth) {
    const layer = (z) => {
      for (let x = 0; x < width + 6; x += 6)
        context.lineTo(x, surface + z + this.sunk(Math.abs(x - middle), z, tip, depth));
    };
    context.fillStyle = colour("--object");
    context.beginPath();
    context.moveTo(0, height);
    layer(0);
    context.lineTo(width, height);
    context.fill();
    context.strokeStyle = colour("--layer");
    context.lineWidth = 1;
    for (let z = 22; z < height - surface; z += 26) {
      context.beginPath();
      layer(z);
      context.stroke();
    }
  }

  // Its lower end is at y; a ghost is an outline.
  finger(context, x, y, half, fill) {
    const top = -2; // it comes from beyond the picture
    context.beginPath();
    context.moveTo(x - half, top);
    context.lineTo(x - half, y - 0.2 * half);
    context.quadraticCurveTo(x - half, y, x - 0.8 * half, y);
    context.lineTo(x + 0.8 * half, y);
    context.quadraticCurveTo(x + half, y, x + half, y - 0.2 * half);
    context.lineTo(x + half, top);
    context.strokeStyle = colour("--ghost");
    context.lineWidth = 1.5;
    if (fill === null) {
      context.setLineDash([5, 4]);
      context.stroke();
      context.setLineDash([]);
      return;
    }
    context.fillStyle = fill;
    context.fill();
  }

  arrow(context, x, y, force_n, peak_n, height) {
    const length = (Math.abs(force_n) / peak_n) * SURFACE * 0.8 * height;
    if (length < 2) return;
    const up = force_n > 0 ? -1 : 1;
    context.strokeStyle = context.fillStyle = colour("--force");
    context.lineWidth = 4;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x, y + up * Math.max(0, length - 8));
    context.stroke();
    context.beginPath();
    context.moveTo(x, y + up * length);
    context.lineTo(x - 7, y + up * (length - 12));
    context.lineTo(x + 7, y + up * (length - 12));
    context.fill();
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.fillText(`${force_n.toFixed(2)} N`, x + 12, y + (up * length) / 2);
  }

  depths(context, width, surface, pixels) {
    const step_m = tick_step(this.scale.depth_m);
    context.fillStyle = context.strokeStyle = colour("--scale");
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.lineWidth = 1;
    for (let depth_m = 0; depth_m <= 1.31 * this.scale.depth_m; depth_m += step_m) {
      const y = surface + pixels(depth_m);
      context.beginPath();
      context.moveTo(width - 8, y);
      context.lineTo(width, y);
      context.stroke();
      context.fillText(`${Number((1e3 * depth_m).toPrecision(4))} mm`, width - 12, y);
    }
  }
}
