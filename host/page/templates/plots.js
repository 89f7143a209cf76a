// The rolling scope, the loop of force and depth, and measured against rendered.

const LEFT = 44, TOP = 18;

// Depth above force; without motion where the reader wants less of it: the newest sample wanders.
function draw_scope(canvas, trace, scale, still) {
  const { context, width, height } = cleared(canvas);
  const gap = TOP + 6, high = (height - TOP - gap - 14) / 2, n = trace.length;
  const start = still ? 0 : trace.count % n, lost = still ? trace.count % n : -1;
  const empty = Math.max(0, n - trace.count);
  const at = (values, factor) => (i) => {
    const row = (start + i) % n;
    const unknown = still ? row >= trace.count || (row >= lost && row < lost + n / 50) : i < empty;
    return unknown ? NaN : factor * values[row];
  };
  const most_m = Math.max(1.3 * scale.depth_m, trace.most_m), most_n = Math.max(1.1 * scale.max_n, trace.most_n);
  const curves = [
    [TOP, "depth, mm", 1e3 * scale.free_m, 1e3 * most_m, at(trace.depth_m, 1e3), colour("--depth")],
    [TOP + high + gap, "force, N", scale.min_n, most_n, at(trace.force_n, 1), colour("--force")],
  ];
  for (const [top, unit, low, most, value_at, tint] of curves) {
    const box = { left: LEFT, top, width: width - LEFT, height: high };
    const y = panel(context, box, low, most, unit);
    columns(context, box, y, n, value_at, tint);
  }
  context.fillStyle = colour("--muted");
  context.textAlign = "right";
  context.textBaseline = "bottom";
  context.fillText(`${SHOWN_S} s`, width, height);
}

// before: loops of other objects, each { name, points: [[depth_m, force_n], ...] }.
function draw_loop(canvas, trace, scene, scale, before) {
  const { context, width, height } = cleared(canvas);
  const box = { left: LEFT, top: TOP, width: width - LEFT, height: height - TOP - 22 };
  const most_m = Math.max(1.3 * scale.depth_m, trace.most_m), least_m = scale.free_m;
  const y = panel(context, box, scale.min_n, Math.max(1.1 * scale.max_n, trace.most_n), "force, N");
  const x = (depth_m) => box.left + ((depth_m - least_m) / (most_m - least_m)) * box.width;
  context.textAlign = "center";
  context.textBaseline = "top";
  const step_m = tick_step(most_m);
  for (let depth_m = 0; depth_m < 0.85 * most_m; depth_m += step_m)
    context.fillText(`${Number((1e3 * depth_m).toPrecision(4))}`, x(depth_m), height - 18);
  context.textAlign = "right";
  context.fillText("depth, mm", width, height - 18);
  context.save();
  within(context, box);
  path(context, scene.measured_n.length, colour("--faint"), 1,
    (i) => [x(scene.recorded_m[i]), y(scene.measured_n[i])]);
  for (const { name, points } of before) {
    path(context, points.length, colour("--faint"), 2, (i) => [x(points[i][0]), y(points[i][1])]);
    const [deep_m, there_n] = points.reduce((most, point) => (point[0] > most[0] ? point : most));
    context.textAlign = "center";
    context.fillText(name, Math.min(x(deep_m), width - 60), Math.max(box.top, y(there_n) - 16));
  }
  const n = trace.length, shown = Math.min(trace.count, n);
  path(context, shown, colour("--force"), 2, (i) => {
    const row = (trace.count - shown + i) % n;
    return [x(trace.depth_m[row]), y(trace.force_n[row])];
  });
  context.restore();
  if (shown > 0) {
    context.fillStyle = colour("--force");
    context.beginPath();
    context.arc(x(trace.newest_m), y(trace.newest_n), 5, 0, 7);
    context.fill();
  }
}

// Through at most so many points of a curve.
function path(context, count, tint, wide, point, most = 3000) {
  const stride = Math.max(1, Math.ceil(count / most));
  context.strokeStyle = tint;
  context.lineWidth = wide;
  context.beginPath();
  for (let i = 0; i < count; i += stride) context.lineTo(...point(i));
  context.stroke();
}

// rendered_n: forces of the C on the recording.
function draw_recording(canvas, scene, rendered_n) {
  canvas.hidden = rendered_n.length === 0;
  if (canvas.hidden) return;
  const { context, width, height } = cleared(canvas), { entry, measured_n } = scene;
  const box = { left: LEFT, top: TOP, width: width - LEFT, height: height - TOP - 20 };
  const peak_n = 1.1 * Math.max(...measured_n), n = measured_n.length;
  const y = panel(context, box, Math.min(0, entry.min_n), peak_n, "force, N");
  columns(context, box, y, n, (i) => measured_n[i], colour("--measured"), 4);
  columns(context, box, y, n, (i) => rendered_n[i], colour("--force"), 1.25);
  context.fillStyle = colour("--muted");
  context.textAlign = "right";
  context.textBaseline = "bottom";
  context.fillText(`${Number((n * entry.dt_s).toPrecision(3))} s`, width, height);
}

function rms_error_n(measured_n, rendered_n) {
  let sum = 0;
  for (let i = 0; i < measured_n.length; i++) sum += (rendered_n[i] - measured_n[i]) ** 2;
  return Math.sqrt(sum / measured_n.length);
}
