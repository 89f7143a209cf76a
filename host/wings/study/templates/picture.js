// The tip of the tool over the surface, on one scale for the whole study.

const SURFACE = 0.35, DEEPEST = 0.85; // of the picture's height
const deepest_m = Number(document.body.dataset.deepestM);

class Picture {
  constructor() {
    this.place = find("picture");
    this.tip = this.place.querySelector(".tip");
    this.guideline = this.place.querySelector(".guideline");
    this.place.querySelector(".surface").style.top = `${100 * SURFACE}%`;
    this.tip.hidden = true;
    this.position_m = this.drawn_m = this.guideline_m = null;
    requestAnimationFrame(() => this.frame());
  }

  height_of(position_m) {
    return SURFACE + ((DEEPEST - SURFACE) * position_m) / deepest_m;
  }

  show(state) {
    this.place.hidden = state.slots.length === 0 && state.guideline_m === null;
    this.guideline_m = state.guideline_m;
    this.guideline.hidden = this.guideline_m === null;
    if (this.guideline_m !== null) this.guideline.style.top = `${100 * this.height_of(this.guideline_m)}%`;
    const column = state.active === null ? 0.5 : (state.active + 0.5) / state.slots.length;
    this.tip.firstElementChild.style.left = `${100 * column}%`;
    this.drawn_m = null;
  }

  frame() {
    if (this.position_m !== this.drawn_m) {
      this.drawn_m = this.position_m;
      const height = Math.min(0.97, Math.max(0.03, this.height_of(this.drawn_m)));
      this.tip.hidden = false;
      this.tip.style.transform = `translateY(${100 * height}%)`;
      this.place.classList.toggle("deep", this.guideline_m !== null && this.drawn_m > this.guideline_m);
      document.body.dataset.moves = Number(document.body.dataset.moves ?? 0) + 1; // for who measures
    }
    requestAnimationFrame(() => this.frame());
  }
}
