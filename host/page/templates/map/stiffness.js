// How stiff the object is where, in colours, and what they mean.

class StiffnessPicture {
  constructor(map) {
    this.map = map;
  }

  // A picture with a pixel a place, of which the outer ones are half outside.
  draw(context, box) {
    const [columns, rows] = this.map.entry.survey;
    const key = ["--map-0", "--map-1", "--map-2"].map(colour).join();
    if (this.painted !== key) this.paint(columns, rows);
    this.painted = key;
    const [wide, high] = [box.width / (columns - 1), box.height / (rows - 1)];
    context.save();
    within(context, { ...box, height: box.height - 2 });
    context.translate(box.left, box.top + box.height);
    context.scale(1, -1); // y goes up
    context.imageSmoothingEnabled = true;
    context.drawImage(this.picture, -wide / 2, -high / 2, columns * wide, rows * high);
    context.restore();
  }

  paint(columns, rows) {
    this.picture = new OffscreenCanvas(columns, rows);
    const context = this.picture.getContext("2d"), image = context.createImageData(columns, rows);
    const { npm, softest_npm, stiffest_npm } = this.map, range = stiffest_npm - softest_npm || 1;
    npm.forEach((its_npm, cell) =>
      image.data.set([...mixed_colour((its_npm - softest_npm) / range), 255], 4 * cell));
    context.putImageData(image, 0, 0);
  }

  legend(context, width) {
    const { map } = this, npmm = (npm) => (npm / 1e3).toPrecision(3);
    const bar = { left: SIDE, width: width - SIDE - EDGE, top: 20, height: 8 };
    const range = context.createLinearGradient(bar.left, 0, bar.left + bar.width, 0);
    for (const at of [0, 1, 2]) range.addColorStop(at / 2, colour(`--map-${at}`));
    context.fillStyle = range;
    context.fillRect(bar.left, bar.top, bar.width, bar.height);
    context.fillStyle = colour("--muted");
    context.textBaseline = "bottom";
    context.textAlign = "left";
    context.fillText(npmm(map.softest_npm), bar.left, 18);
    context.textAlign = "right";
    context.fillText(npmm(map.stiffest_npm), bar.left + bar.width, 18);
    context.textAlign = "center";
    context.fillText(`N/mm at ${Number((1e3 * map.depth_m).toPrecision(3))} mm`, bar.left + bar.width / 2, 18);
  }
}

// From soft, 0, to stiff, 1: red, green, blue.
function mixed_colour(share) {
  const at = 2 * Math.min(1, Math.max(0, share)), low = Math.min(1, Math.floor(at));
  const parts = (name) => [1, 3, 5].map((i) => parseInt(colour(name).slice(i, i + 2), 16));
  const [from, to] = [parts(`--map-${low}`), parts(`--map-${low + 1}`)];
  return from.map((its, k) => Math.round(its + (at - low) * (to[k] - its)));
}
