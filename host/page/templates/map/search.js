// Find the lump: with the colours off, by the force alone.

let map = null, map_view, placed_ms = -READ_MS; // map: null if the object is the same everywhere
const found = { colours: true, searches: false, marks_m: [] };

// For a scene that was loaded: its map, if it has one.
function take_map() {
  map = ObjectMap.of(scene);
  find("map-figure").hidden = map === null;
  if (map === null) return;
  map_view = new MapView(find("map"), map);
  find("map").dataset.stiffest = map.stiffest_m; // for who measures the page from outside
  find("map").dataset.depth = map.depth_m;
  show_colours();
  find("found").textContent = "";
  trials = null;
  find("save-trials").hidden = true;
  find("slides").hidden = !map.slides;
  find("held").hidden = map.slides;
}

function show_colours(marks_m = []) {
  Object.assign(found, { colours: true, searches: false, marks_m });
  read_search();
}

function search() {
  if (found.searches) return trials === null ? show_colours() : end_trials();
  trials = null;
  find("save-trials").hidden = true;
  hide_colours(1);
  find("found").textContent = "Press, and compare depth and force: where is it stiffest?";
  read_search();
}

// The map is turned by chance: what was seen of it does not help. part: of it that is shown.
function hide_colours(part) {
  Object.assign(found, { colours: false, searches: true, marks_m: [] });
  map_view.turned = [Math.random() < 0.5, Math.random() < 0.5];
  map_view.show_part(part);
  map.trail = [];
  map.touched_m = null;
}

function read_search() {
  if (!found.searches && map !== null) {
    map_view.turned = [false, false];
    map_view.show_part(1);
  }
  find("search").textContent = found.searches ? "Give up: show the colours" : "Find the lump with the colours off";
  find("mark").hidden = !found.searches;
  find("trials").hidden = found.searches;
}

function mark() {
  if (!found.searches) return;
  if (map.touched_m === null) {
    find("found").textContent = "Press somewhere first: the mark is where you pressed last.";
    return;
  }
  const off_mm = 1e3 * way_m(map.touched_m, map.stiffest_m), npmm = (npm) => (npm / 1e3).toFixed(2);
  if (trials !== null) return end_trial(off_mm);
  find("found").textContent = `${off_mm.toFixed(1)} mm from the stiffest place, which has ${
    npmm(map.stiffest_npm)} N/mm; yours has ${npmm(map.stiffness_npm(map.touched_m))}, and the softest ${
    npmm(map.softest_npm)}.`;
  show_colours([map.touched_m]);
}

function draw_map(now_ms) {
  if (map === null || intent === null) return;
  map_view.draw(found);
  if (now_ms - placed_ms < READ_MS) return;
  placed_ms = now_ms;
  const at_mm = map_view.shown_m(map.at_m).map((its_m) => (1e3 * its_m).toFixed(1));
  const words = trials !== null && found.searches ? [] : [`x ${at_mm[0]} mm, y ${at_mm[1]} mm`];
  if (map.touches) {
    words.push(`${(1e3 * trace.newest_m).toFixed(2)} mm deep`, `${trace.newest_n.toFixed(2)} N`);
    if (map.slides) words.push(`${Math.hypot(...map.force_n).toFixed(2)} N sideways`);
  }
  find("place").textContent = words.join(", ");
}
