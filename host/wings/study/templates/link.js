// What the session shows, and the acts sent back to it: each with the number of the state it answers.

const find = (id) => document.getElementById(id);
const GONE = "The session has ended or was interrupted. Please wait for the experimenter.";

function listen(take) {
  const events = new EventSource("events");
  for (const name of ["state", "warning", "position"])
    events.addEventListener(name, (event) => take[name](JSON.parse(event.data)));
  events.addEventListener("open", () => { find("gone").textContent = ""; });
  events.addEventListener("error", () => { find("gone").textContent = GONE; });
  events.addEventListener("over", (event) => {
    events.close();
    find("gone").textContent = event.data || GONE;
  });
}

// Whether the session took it.
async function tell(number, kind, value) {
  try {
    const body = JSON.stringify({ state: number, kind, value });
    const answer = await fetch("act", { method: "POST", body });
    return answer.ok && (await answer.json()).accepted;
  } catch {
    return false; // the session is gone: its events say so
  }
}
