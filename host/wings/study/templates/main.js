// What a key does in the state that is shown.

const CALM_MS = 400; // nobody reads a new question sooner: keys until then were meant for the old one

const picture = new Picture(), answer = new AnswerPanel();
let state = null, about = "", shown_ms = 0;
let pending = Promise.resolve(); // what was sent last is answered
let waiting = true; // for the session: something was sent, or nothing is asked yet

// A question stays the same while the thing under the tool changes: what was typed stays too.
function identity(state) {
  const { title, instruction, ask, slots } = state;
  return JSON.stringify(is_plain(state) ? [title, instruction] : [title, ask, slots]);
}

function take_state(next) {
  const fresh = identity(next) !== about || state.answered;
  state = next;
  about = identity(next);
  waiting = state.answered;
  show_words(state);
  picture.show(state);
  if (fresh) {
    shown_ms = performance.now();
    answer.close();
    if (state.ask !== null && state.slots.length === 0 && !waiting) answer.open(state.ask);
    say("");
  }
  show_keys(state, answer.is_open, waiting);
}

function say(text) {
  write("said", text);
}

async function send(kind, value) {
  waiting = true;
  show_keys(state, answer.is_open, waiting);
  const accepted = await tell(state.number, kind, value);
  state.answered = waiting = accepted;
  show_keys(state, answer.is_open, waiting);
  if (kind === "answer") say(accepted ? "Thank you." : "Not taken: please press Enter again.");
}

// A slot by its digit, or by an arrow from the one that is chosen.
function slot_of(key) {
  const { slots, active, wanted } = state, last = slots.length - 1, at = wanted ?? active;
  if (/^[1-9]$/.test(key) && Number(key) <= slots.length) return Number(key) - 1;
  if (key === "ArrowLeft") return at === null ? 0 : Math.max(0, at - 1);
  if (key === "ArrowRight") return at === null ? last : Math.min(last, at + 1);
  return null;
}

function while_answering(key) {
  if (key === "Enter") {
    say(answer.complaint);
    if (answer.complaint === "") pending = send("answer", answer.value);
    return true;
  }
  if (key === "Escape") {
    if (state.slots.length > 0) answer.close();
    else answer.clear();
    say("");
    show_keys(state, answer.is_open, waiting);
    return true;
  }
  answer.hold();
  return answer.choose(key);
}

function while_feeling(key) {
  const slot = state.slots.length > 0 ? slot_of(key) : null;
  if (slot !== null) {
    if (slot !== (state.wanted ?? state.active)) tell(state.number, "slot", slot);
    return true;
  }
  if (key === "Enter" && state.ask !== null) {
    answer.open(state.ask);
    show_keys(state, true, waiting);
    return true;
  }
  if ((key === "Enter" || key === " ") && is_plain(state)) {
    pending = send("next", 0);
    return true;
  }
  return false;
}

addEventListener("keydown", (event) => {
  allow_sound();
  if (event.isComposing || event.ctrlKey || event.metaKey || event.altKey || state === null) return;
  const held = event.repeat && event.key !== "Backspace";
  const early = event.timeStamp - shown_ms < CALM_MS;
  if (waiting || held || early) event.preventDefault();
  else if (answer.is_open ? while_answering(event.key) : while_feeling(event.key)) event.preventDefault();
});

listen({
  state: async (next) => {
    await pending; // whether it was taken decides whether this is a new question
    take_state(next);
  },
  warning: warn,
  position: (position_m) => { picture.position_m = position_m; },
});
