// Pointer, wheel, finger and keys on the map.

const HELD_SHARE = 0.6, HELD_MS = 400; // a press: of the deepest intent, and its time
const WHEEL_SHARE = 0.04, KEY_SHARE = 1 / 60; // of the deepest intent; of the map, a key's step
const KEY_STEPS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

// To an intended depth once the tool is above its place, evenly.
function press_there(time_ms) {
  const begins_ms = time_ms + map.wait_ms;
  find("hint").hidden = true;
  intent.points = [[begins_ms, intent.now_m], [begins_ms + HELD_MS, HELD_SHARE * intent.deepest_m]];
}

function press_deeper(by_share) {
  const to_m = intent.points.at(-1)?.[1] ?? intent.now_m;
  intent.add(performance.now(), to_m + by_share * (intent.deepest_m - intent.free_m));
}

function press_map_with_pointer(canvas) {
  let pressing = null;
  const follow = (event) => {
    if (map === null || intent === null || (pressing !== null && pressing !== event.pointerId)) return;
    const box = canvas.getBoundingClientRect(), all = event.getCoalescedEvents?.() ?? [];
    for (const one of all.length > 0 ? all : [event])
      map.place.go(one.timeStamp, map_view.within(map_view.place_at(one.clientX - box.left, one.clientY - box.top)));
  };
  canvas.addEventListener("pointermove", follow);
  canvas.addEventListener("pointerdown", (event) => {
    if (map === null || intent === null || event.button > 0) return;
    if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
    follow(event);
    pressing = event.pointerId;
    press_there(event.timeStamp);
  });
  for (const kind of ["pointerup", "pointercancel"])
    canvas.addEventListener(kind, (event) => {
      if (pressing !== event.pointerId) return;
      pressing = null;
      intent?.let_go(event.timeStamp);
    });
  canvas.addEventListener("wheel", (event) => {
    if (map === null || intent === null || event.ctrlKey) return;
    press_deeper(event.deltaY > 0 ? WHEEL_SHARE : -WHEEL_SHARE);
    event.preventDefault();
  }, { passive: false });
}

function step_place(steps) {
  const spans_m = map_view.spans_m, to_m = map.place.to_m;
  const step_m = map_view.step_m(steps.map((its, k) => its * KEY_SHARE * spans_m[k]));
  map.place.go(performance.now(), map_view.within(to_m.map((its_m, k) => its_m + step_m[k])));
}

function press_map_with_keys(canvas) {
  const acts = {
    Enter: (now_ms) => press_there(now_ms),
    PageDown: () => press_deeper(WHEEL_SHARE),
    PageUp: () => press_deeper(-WHEEL_SHARE),
    " ": (now_ms) => intent.let_go(now_ms),
    m: () => mark(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (map === null || intent === null || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key === "M" ? "m" : event.key;
    if (key in KEY_STEPS) step_place(KEY_STEPS[key]);
    else if (key in acts && !(event.repeat && key === "Enter")) acts[key](performance.now());
    else return;
    event.preventDefault();
  });
}

function listen_to_map() {
  press_map_with_pointer(find("map"));
  press_map_with_keys(find("map"));
  find("search").addEventListener("click", search);
  find("mark").addEventListener("click", mark);
  find("trials").addEventListener("click", begin_trials);
  find("save-trials").addEventListener("click", () => save(trials_csv(), "trials"));
}
