// A scene's map in C: how stiff the object is where, and ticks of a tool of three axes.

const TRAIL_MS = 4000, TRAIL_STEP_M = 2e-4;
const LIMIT_SHARE = 0.99; // of the greatest force: cut there, all places are alike

class ObjectMap {
  // Takes the scene's calls of a press over: they have x and y besides. null: the scene has no map.
  static of(scene) {
    return scene.entry.map === undefined ? null : new ObjectMap(scene);
  }

  constructor(scene) {
    this.scene = scene;
    this.entry = scene.entry.map;
    const c = this.c = scene.c, names = ["x_m", "y_m", "x_n", "y_n"];
    for (const name of names)
      this[name] = new scene.Real(c.memory.buffer, c[`sp_page_map_${name}`](), scene.rows);
    this.intended_m = ["x", "y"].map((axis) =>
      new Float64Array(c.memory.buffer, c[`sp_page_map_intended_${axis}_m`](), scene.rows));
    this.ends_m = new Float64Array(c.memory.buffer, c.sp_page_survey_ends_m(), 4);
    this.slides = c.sp_page_map_slides() === 1;
    this.choose_depth();
    this.npm = this.survey(...this.entry.survey, this.entry.first_m, this.entry.last_m);
    this.softest_npm = Math.min(...this.npm);
    this.stiffest_npm = Math.max(...this.npm);
    this.stiffest_m = this.place_of(this.npm.indexOf(this.stiffest_npm));
    const replayed_m = scene.entry.recording?.place_m ?? this.stiffest_m;
    scene.c = {
      ...c,
      sp_page_device: c.sp_page_map_device,
      sp_page_hold: c.sp_page_map_hold,
      sp_page_start: (depth_m) => this.start(depth_m),
      sp_page_press: (ticks, dt_s) => this.press(ticks, dt_s),
      sp_page_replay: (rows) => c.sp_page_map_replay(rows, ...replayed_m),
    };
  }

  // The deepest tenth of the recorded depth at which no node of the map reaches the force's limit.
  choose_depth() {
    const { nodes, first_m, last_m, depth_m } = this.entry, limit_n = LIMIT_SHARE * this.scene.entry.max_n;
    for (let tenths = 10; tenths > 0; tenths--) {
      this.depth_m = (tenths / 10) * depth_m;
      const most_npm = Math.max(...this.survey(...nodes, first_m, last_m));
      if (most_npm * this.depth_m < limit_n) return;
    }
  }

  // Force over depth of a press, N/m, at columns x rows places between two.
  survey(columns, rows, first_m, last_m) {
    const { c, depth_m } = this, { dt_s } = this.scene.entry;
    this.ends_m.set([...first_m, ...last_m]);
    const at = c.sp_page_survey(columns, rows, depth_m, this.entry.press_ticks, dt_s);
    const force_n = new Float64Array(c.memory.buffer, at, columns * rows);
    return Float64Array.from(force_n, (its_n) => its_n / depth_m);
  }

  stiffness_npm(place_m) {
    return this.survey(1, 1, place_m, place_m)[0];
  }

  // Of the survey's cell with that number.
  place_of(cell) {
    const [columns, rows] = this.entry.survey, { first_m, last_m } = this.entry;
    const shares = [(cell % columns) / (columns - 1), Math.floor(cell / columns) / (rows - 1)];
    return shares.map((share, k) => first_m[k] + share * (last_m[k] - first_m[k]));
  }

  start(depth_m) {
    const { first_m, last_m } = this.entry;
    this.at_m ??= first_m.map((its_m, k) => (its_m + last_m[k]) / 2);
    this.place = new Place(this.entry, this.at_m);
    this.force_n = [0, 0];
    this.touched_m = null; // where the tool touched last
    this.touches = false;
    this.presses = 0;
    this.most_n = 0; // of the lateral force
    this.trail = [];
    this.count = 0;
    this.kept = Array.from({ length: 4 }, () => new this.scene.Real(trace.kept_m.length));
    this.c.sp_page_map_start(...this.at_m, depth_m);
  }

  press(ticks, dt_s) {
    this.place.fill(this.intended_m, ticks, intent.at_ms - 1e3 * ticks * dt_s, 1e3 * dt_s);
    this.c.sp_page_map_press(ticks, dt_s);
    if (ticks > 0) this.take(ticks);
  }

  take(ticks) {
    const found = [this.x_m, this.y_m, this.x_n, this.y_n], depth_m = this.scene.position_m;
    for (let i = 0; i < ticks; i++, this.count++) {
      if (this.count < trace.kept_m.length)
        found.forEach((its, k) => { this.kept[k][this.count] = its[i]; });
      if (depth_m[i] > 0) this.touched_m = [this.x_m[i], this.y_m[i]];
      this.most_n = Math.max(this.most_n, Math.hypot(this.x_n[i], this.y_n[i]));
    }
    if (!this.touches && depth_m[ticks - 1] > 0) this.presses++;
    this.touches = depth_m[ticks - 1] > 0;
    this.at_m = [this.x_m[ticks - 1], this.y_m[ticks - 1]];
    this.force_n = [this.x_n[ticks - 1], this.y_n[ticks - 1]];
    this.leave_trail(performance.now());
  }

  // Where the tool touched in the last seconds, and the lateral force there.
  leave_trail(now_ms) {
    const last = this.trail.at(-1);
    const moved = last === undefined || !last.touches || way_m(last.at_m, this.at_m) > TRAIL_STEP_M;
    if (this.touches ? moved : last?.touches)
      this.trail.push({ now_ms, at_m: this.at_m, force_n: this.force_n, touches: this.touches });
    while (this.trail.length > 0 && this.trail[0].now_ms < now_ms - TRAIL_MS) this.trail.shift();
  }

  // Until the tool is above the place that the hand intends: a press begins then.
  get wait_ms() {
    if (this.touches) return 0;
    return (1e3 * way_m(this.at_m, this.place.to_m)) / this.c.sp_page_map_carried_mps();
  }

  // The page's file, with the place of each row, and the lateral force if there is one.
  csv(text) {
    const columns = ["place_x_m", "place_y_m", ...(this.slides ? ["lateral_x_N", "lateral_y_N"] : [])];
    const row = (i) => columns.map((_, k) => this.kept[k][i]);
    return text.trimEnd().split("\n")
      .map((line, i) => `${line},${i === 0 ? columns : row(i - 1)}\n`).join("");
  }
}

function way_m(from_m, to_m) {
  return Math.hypot(to_m[0] - from_m[0], to_m[1] - from_m[1]);
}
