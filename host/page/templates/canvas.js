// Canvases in the page's own colours and in the screen's own pixels.

// Colours of the style sheet, looked up once for light or dark.
const palette = new Map();

function colour(name) {
  if (!palette.has(name))
    palette.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  return palette.get(name);
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

// A step of 1, 2 or 5 that parts the range into two to five.
function tick_step(range) {
  const rough = range / 4, decade = 10 ** Math.floor(Math.log10(rough));
  return decade * [1, 2, 5, 10].find((factor) => factor * decade >= rough);
}

// A panel of a plot: lines at round values, and their numbers on its left.
function panel(context, box, low, high, unit) {
  const y = (value) => box.top + ((high - value) / (high - low)) * box.height;
  const step = tick_step(high - low);
  context.strokeStyle = colour("--line");
  context.fillStyle = colour("--muted");
  context.lineWidth = 1;
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (let value = Math.ceil(low / step) * step; value <= high + 1e-9; value += step) {
    context.beginPath();
    context.moveTo(box.left, y(value));
    context.lineTo(box.left + box.width, y(value));
    context.stroke();
    context.fillText(String(Number(value.toPrecision(6))), box.left - 6, y(value));
  }
  context.textAlign = "left";
  context.textBaseline = "top";
  context.fillText(unit, box.left, box.top - 15);
  return y;
}

// A curve with more samples than pixels: from the least to the greatest of each column.
function columns(context, box, y, count, value_at, tint, wide = 2) {
  context.save();
  within(context, box);
  context.strokeStyle = tint;
  context.lineWidth = wide;
  context.beginPath();
  let before = null;
  for (let column = 0; column < box.width; column++) {
    const begin = Math.floor((column * count) / box.width);
    const end = Math.max(begin + 1, Math.floor(((column + 1) * count) / box.width));
    let low = Infinity, high = -Infinity, last = NaN;
    for (let i = begin; i < end && i < count; i++) {
      const value = value_at(i);
      if (Number.isNaN(value)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
      last = value;
    }
    if (low > high) {
      before = null;
      continue;
    }
    const x = box.left + column + 0.5;
    if (before === null) context.moveTo(x, y(low));
    else context.lineTo(x, y(low));
    if (y(low) - y(high) > 1) context.lineTo(x, y(high));
    before = last;
    context.lineTo(x, y(last));
  }
  context.stroke();
  context.restore();
}

// What follows is drawn in the panel alone.
function within(context, box) {
  context.beginPath();
  context.rect(box.left, box.top, box.width, box.height + 2);
  context.clip();
}
