// Ten searches, each on another part of the map and mirrored by chance; nothing is shown in between.

const TRIALS = 10, PART = 0.7; // of the map along each axis
const FOUND_SHARE = 0.75; // of the range of stiffness: so stiff is what was marked, where it was found
let trials = null, began_ms = 0; // those that have ended; null: a search alone

function begin_trials() {
  trials = [];
  find("save-trials").hidden = true;
  next_trial();
}

function next_trial() {
  hide_colours(PART);
  map.presses = 0;
  began_ms = performance.now();
  map.place.go(began_ms, map_view.middle_m);
  find("found").textContent = `Trial ${trials.length + 1} of ${TRIALS}: where is it stiffest?`;
  read_search();
}

function end_trial(off_mm) {
  const seconds = (performance.now() - began_ms) / 1e3, npm = map.stiffness_npm(map.touched_m);
  const share = (npm - map.softest_npm) / (map.stiffest_npm - map.softest_npm || 1);
  trials.push({ at_m: map.touched_m, off_mm, share, seconds, presses: map.presses });
  if (trials.length < TRIALS) next_trial();
  else end_trials();
}

function end_trials() {
  const off_mm = trials.map((one) => one.off_mm).sort((a, b) => a - b), n = off_mm.length;
  const median_mm = (off_mm[Math.floor((n - 1) / 2)] + off_mm[Math.floor(n / 2)]) / 2;
  const near = trials.filter((one) => one.share >= FOUND_SHARE).length;
  show_colours(trials.map((one) => one.at_m));
  find("save-trials").hidden = n === 0;
  find("found").textContent = n === 0 ? "" : `${near} of ${n} found: at ${100 * FOUND_SHARE} % of the range of ` +
    `stiffness or more. ${median_mm.toFixed(1)} mm from the stiffest place in the median.`;
}

function trials_csv() {
  const rows = trials.map(({ at_m, off_mm, share, seconds, presses }, k) =>
    [k + 1, ...at_m, ...map.stiffest_m, (off_mm / 1e3).toPrecision(4), share.toFixed(3), seconds.toFixed(2), presses]);
  return "trial,marked_x_m,marked_y_m,stiffest_x_m,stiffest_y_m,off_m,stiffness_share,seconds,presses\n" +
    rows.map((row) => `${row}\n`).join("");
}
