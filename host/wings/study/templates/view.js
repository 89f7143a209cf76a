// The words of a state: what is asked of the person, what is under the tool, which keys do what.

function show_words(state) {
  document.querySelector("main").hidden = false;
  document.querySelector("main").classList.toggle("plain", is_plain(state));
  // Only what differs is written: a screen reader says what changes.
  write("title", state.title);
  write("instruction", state.instruction);
  find("slots").hidden = find("change").hidden = state.slots.length === 0;
  find("slots").replaceChildren(...state.slots.map((words, k) => {
    const item = listed(k, words);
    item.classList.toggle("active", k === state.active);
    item.classList.toggle("wanted", k === state.wanted && k !== state.active);
    if (k === state.active) item.setAttribute("aria-current", "true");
    return item;
  }));
  write("change", under_the_tool(state));
  write("question", state.ask?.question ?? "");
}

function write(id, text) {
  if (find(id).textContent !== text) find(id).textContent = text;
}

function is_plain(state) {
  return state.ask === null && state.slots.length === 0;
}

function under_the_tool({ slots, active, wanted }) {
  if (wanted !== null && wanted !== active) return `For ${slots[wanted]}: lift the tool off the surface.`;
  if (active !== null) return `Under the tool: ${slots[active]}`;
  return "";
}

function show_keys(state, answering, waiting) {
  const keys = [], last = Math.min(9, (answering ? state.ask?.choices : state.slots)?.length ?? 0);
  if (waiting) return find("keys").replaceChildren();
  if (answering) {
    const { kind } = state.ask;
    if (kind === "number") keys.push(["0 – 9", "type"]);
    if (kind === "choice") keys.push([`1 – ${last}`, "or arrows: choose"]);
    keys.push(["Enter", "confirm"], ["Esc", state.slots.length > 0 ? "feel again" : "clear"]);
  } else { // what goes on by the space bar says so itself: not everything does
    if (last > 0) keys.push(["← →", `or 1 – ${last}: choose`]);
    if (state.ask !== null) keys.push(["Enter", "answer"]);
  }
  return find("keys").replaceChildren(...keys.map(([key, what]) => {
    const item = document.createElement("span"), name = document.createElement("kbd");
    name.textContent = key;
    item.append(name, ` ${what}`);
    return item;
  }));
}
