// A warning in words, with two short tones.

const SHOWN_MS = 2000;
let audio = null, hiding = 0;

// Browsers let a page sound only after a key.
function allow_sound() {
  audio ??= new AudioContext();
  if (audio.state === "suspended") audio.resume();
}

function tone(begin_s) {
  const source = audio.createOscillator(), loudness = audio.createGain();
  source.frequency.value = 660;
  loudness.gain.setValueAtTime(0, begin_s);
  loudness.gain.linearRampToValueAtTime(0.4, begin_s + 0.01); // ramps: no clicks
  loudness.gain.setValueAtTime(0.4, begin_s + 0.13);
  loudness.gain.linearRampToValueAtTime(0, begin_s + 0.15);
  source.connect(loudness).connect(audio.destination);
  source.start(begin_s);
  source.stop(begin_s + 0.15);
}

function warn(text) {
  find("warning").textContent = text;
  clearTimeout(hiding);
  hiding = setTimeout(() => { find("warning").textContent = ""; }, SHOWN_MS);
  if (audio?.state !== "running") return;
  tone(audio.currentTime);
  tone(audio.currentTime + 0.22);
  document.body.dataset.tones = Number(document.body.dataset.tones ?? 0) + 2; // for who tests
}
