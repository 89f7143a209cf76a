// The answer to the question, as it is typed or chosen; nothing counts before Enter.

class AnswerPanel {
  constructor() {
    this.input = find("typed");
    this.input.addEventListener("input", () => this.cleaned());
    this.ask = null;
    this.close();
  }

  get is_open() {
    return !find("answer").hidden;
  }

  open(ask) {
    this.ask = ask;
    find("answer").hidden = false;
    const choice = ask.kind === "choice";
    this.input.hidden = choice;
    this.input.className = ask.kind;
    this.input.rows = ask.kind === "text" ? 4 : 1;
    this.input.inputMode = ask.kind === "number" ? "numeric" : "text";
    this.input.maxLength = ask.kind === "number" ? 9 : Number(document.body.dataset.longest);
    find("choices").hidden = !choice;
    find("choices").replaceChildren(...ask.choices.map((words, k) => listed(k, words, "option")));
    this.clear();
  }

  close() {
    find("answer").hidden = true;
    this.input.value = "";
    this.input.blur();
  }

  clear() {
    this.input.value = "";
    this.chosen = null;
    this.mark();
    this.hold();
  }

  hold() {
    if (this.is_open && !this.input.hidden) this.input.focus();
  }

  cleaned() {
    if (this.ask.kind !== "number") return;
    const sign = this.ask.min < 0 && this.input.value.startsWith("-") ? "-" : "";
    this.input.value = sign + this.input.value.replace(/[^0-9]/g, "");
  }

  mark() {
    for (const [k, choice] of Array.from(find("choices").children).entries())
      choice.setAttribute("aria-selected", k === this.chosen);
    find("choices").children[this.chosen]?.focus(); // is read out, and comes into sight
  }

  // A key that chooses; what is typed comes to the input by itself.
  choose(key) {
    if (this.ask.kind !== "choice") return false;
    const last = this.ask.choices.length - 1, digit = /^[1-9]$/.test(key) ? Number(key) - 1 : null;
    if (digit !== null && digit <= last) this.chosen = digit;
    else if (key === "ArrowDown" || key === "ArrowRight") this.chosen = Math.min(last, (this.chosen ?? -1) + 1);
    else if (key === "ArrowUp" || key === "ArrowLeft") this.chosen = Math.max(0, (this.chosen ?? last + 1) - 1);
    else return false;
    this.mark();
    return true;
  }

  get value() {
    return this.ask.kind === "choice" ? this.ask.choices[this.chosen] ?? "" : this.input.value.replace(/\s+/g, " ").trim();
  }

  // What is wrong with it, in words; nothing where it is an answer.
  get complaint() {
    const { kind, min, max, choices } = this.ask, value = this.value;
    if (kind === "number") {
      const fine = /^-?[0-9]+$/.test(value) && Number(value) >= min && Number(value) <= max;
      return fine ? "" : `Please type a number from ${min} to ${max}.`;
    }
    if (kind === "choice") return value !== "" ? "" : `Please choose one of the ${choices.length}.`;
    return value !== "" ? "" : "Please type something; a dash if you have nothing to say.";
  }
}

function listed(k, words, role) {
  const item = document.createElement("li"), key = document.createElement("kbd");
  if (role) item.setAttribute("role", role);
  if (role) item.tabIndex = -1;
  key.textContent = k < 9 ? k + 1 : "";
  item.append(key, words);
  return item;
}
