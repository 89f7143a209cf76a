// Presses the page's object as a person would, and leaves in the document what came of it.
// Headless browsers draw no frames of their own while time is simulated.
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 1000 / 60);
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
// One turn of the event loop, in which simulated time stands still: other threads may be at work.
const turn = () => new Promise((done) => {
  const channel = new MessageChannel();
  channel.port1.onmessage = done;
  channel.port2.postMessage(0);
});
const errors = [];
addEventListener("error", (event) => errors.push(event.message));
addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
const element = (id) => document.getElementById(id);
const words = (id) => element(id).textContent;
const there_and_back = Array.from({ length: 80 }, (_, i) => 0.3 + 0.6 * Math.sin((Math.PI * i) / 79) ** 2);

function change(id, value, kind) {
  element(id).value = value;
  element(id).dispatchEvent(new Event(kind));
}

async function press_with_pointer(path) {
  const box = element("object").getBoundingClientRect();
  const point = (kind, share) => element("object").dispatchEvent(new PointerEvent(kind, {
    pointerId: 1, bubbles: true, clientX: box.left + box.width / 2, clientY: box.top + share * box.height,
  }));
  point("pointerdown", path[0]);
  for (const share of path) {
    point("pointermove", share);
    await wait(20);
  }
  point("pointerup", path.at(-1));
}

async function downloaded() {
  let text = "";
  URL.createObjectURL = (blob) => { blob.text().then((found) => { text = found; }); return "#"; };
  element("download").click();
  while (text === "") await turn();
  return text;
}

addEventListener("load", async () => {
  const how = window.how ?? {};
  while (!document.body.classList.contains("ready") && words("broken") === "") await turn();
  if (words("broken") !== "") {
    document.body.dataset.found = JSON.stringify({ csv: "", errors, broken: words("broken") });
    return;
  }
  for (const [id, value] of Object.entries(how.sliders ?? {})) change(id, value, "input");
  if (how.pick !== undefined) {
    change("picker", how.pick, "change");
    while (words("object-name") !== element("picker").selectedOptions[0].textContent) await wait(20);
  }
  if (how.map !== undefined) await window.press_map(how.map);
  else await press_with_pointer(how.path ?? there_and_back);
  const vibration = words("vibration"), state = words("notes");
  await wait(600);
  const found = { errors, vibration, state, csv: await downloaded() };
  for (const id of ["verdict", "limit", "device", "proof", "broken", "object-name", "error", "notes", "said"])
    found[id] = words(id);
  found.tick = element("tick").textContent;
  found.fetched = performance.getEntriesByType("resource").map((one) => one.name);
  document.body.dataset.found = JSON.stringify(found);
});
