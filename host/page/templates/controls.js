// Pointer, finger and keys: what people do to the object.

const KEYS = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 };

function press_with_pointer(canvas) {
  let pressing = null;
  const follow = (event) => {
    if (pressing !== event.pointerId || intent === null) return;
    const all = event.getCoalescedEvents?.() ?? [];
    const top = canvas.getBoundingClientRect().top;
    for (const one of all.length > 0 ? all : [event])
      intent.add(one.timeStamp, view.intent_at(one.clientY - top, intent));
  };
  canvas.addEventListener("pointerdown", (event) => {
    pressing = event.pointerId;
    find("hint").hidden = true;
    follow(event);
  });
  addEventListener("pointermove", follow);
  for (const kind of ["pointerup", "pointercancel"])
    addEventListener(kind, (event) => {
      if (pressing !== event.pointerId) return;
      pressing = null;
      intent?.let_go(event.timeStamp);
    });
}

function press_with_keys(canvas) {
  canvas.addEventListener("keydown", (event) => {
    if (intent === null) return;
    if (event.key in KEYS) intent.key = KEYS[event.key];
    else if (event.key === "End") intent.add(performance.now() + LET_GO_MS, intent.deepest_m);
    else if (event.key === " " || event.key === "Home") intent.let_go(performance.now());
    else return;
    find("hint").hidden = true;
    event.preventDefault();
  });
  const release = () => { if (intent !== null) intent.key = 0; };
  canvas.addEventListener("keyup", (event) => { if (event.key in KEYS) release(); });
  canvas.addEventListener("blur", release);
}

function listen() {
  const canvas = find("object"), redraw = () => draw_recording(find("recording"), scene, rendered_n);
  press_with_pointer(canvas);
  press_with_keys(canvas);
  for (const id of ["stiffness", "mass", "delay"]) find(id).addEventListener("input", hold);
  find("picker").addEventListener("change", (event) => pick(Number(event.target.value)));
  find("download").addEventListener("click", download);
  find("again").addEventListener("click", start);
  find("stop").addEventListener("click", stop);
  find("reset").addEventListener("click", () => source.reset?.());
  find("explain").addEventListener("click", () => { find("meaning").open = true; });
  addEventListener("keydown", (event) => { if (event.key === "q" && !find("stop").hidden) stop(); });
  find("connect").hidden = live || !("serial" in navigator);
  find("connect").addEventListener("click", connect);
  for (const change of ["resize", "focus"]) addEventListener(change, redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    palette.clear();
    redraw();
  });
}
