// Presses the page's map by script, beside press_by_script.js: path: [share of the map's picture
// from the left, from the top, for how many ms] of a pointer that is held; a pause lets it go.
window.press_map = async (paths) => {
  const canvas = document.getElementById("map"), box = canvas.getBoundingClientRect();
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const point = (kind, [across, down]) => canvas.dispatchEvent(new PointerEvent(kind, {
    pointerId: 1, bubbles: true, clientX: box.left + across * box.width, clientY: box.top + down * box.height,
  }));
  for (const path of paths) {
    point("pointerdown", path[0]);
    for (const step of path) {
      point("pointermove", step);
      await wait(step[2]);
    }
    point("pointerup", path.at(-1));
    await wait(600);
  }
};
