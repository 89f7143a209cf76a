// Where ticks come from: the hand on this page, a session on this PC, a board on a cable. The page
// closes no force loop but its own: of the other two it shows what they rendered, and stops them.

const MAX_GAP_MS = 100; // a page in the background has no frames: what it missed is left out

class HandOnPage {
  constructor(scene, intent) {
    this.scene = scene;
    this.intent = intent;
    this.rendered_ms = null;
    this.owed = 0; // ticks, less than one
  }

  // Rows of the ticks up to now.
  advance(now_ms) {
    const dt_ms = 1e3 * this.scene.entry.dt_s;
    const since_ms = Math.min(MAX_GAP_MS, now_ms - (this.rendered_ms ?? now_ms));
    this.rendered_ms = now_ms;
    this.owed += since_ms / dt_ms;
    const ticks = Math.min(this.scene.rows, Math.floor(this.owed));
    this.owed -= ticks;
    this.intent.at_ms = now_ms - (ticks + this.owed) * dt_ms;
    this.intent.fill(this.scene.intended_m, ticks, dt_ms);
    this.scene.c.sp_page_press(ticks, this.scene.entry.dt_s);
    return ticks;
  }
}

// Bytes of springpot serial out of elsewhere; the same C takes them apart.
class Link {
  constructor(scene) {
    this.scene = scene;
    this.waiting = [];
  }

  advance() {
    const bytes = this.waiting.shift();
    if (bytes === undefined) return 0;
    const room = this.scene.link.length;
    if (bytes.length > room) this.waiting.unshift(bytes.subarray(room));
    this.scene.link.set(bytes.subarray(0, room));
    return this.scene.c.sp_page_receive(Math.min(room, bytes.length));
  }

  get other_hash() {
    const at = this.scene.c.sp_page_other_hash();
    if (at === 0) return null;
    const bytes = new Uint8Array(this.scene.c.memory.buffer, at, 32);
    return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
  }
}

// `springpot run --page`: frames come as events, STOP goes back as a request.
class Session extends Link {
  constructor(scene, say) {
    super(scene);
    this.events = new EventSource("frames");
    this.events.onmessage = (event) =>
      this.waiting.push(Uint8Array.from(atob(event.data), (letter) => letter.charCodeAt(0)));
    this.events.addEventListener("over", (event) => {
      this.events.close();
      say(`The session has ended: ${event.data}`);
    });
    this.events.onerror = () => say("No word from the session: is `springpot run` still there?");
    this.stop = () => fetch("stop", { method: "POST" });
    this.reset = () => fetch("reset", { method: "POST" });
  }
}

// A board that renders, over Web Serial.
class Board extends Link {
  static async open(scene, say) {
    const port = await navigator.serial.requestPort();
    await port.open({ baudRate: scene.entry.baud });
    return new Board(scene, port, say);
  }

  constructor(scene, port, say) {
    super(scene);
    this.writer = port.writable.getWriter();
    this.read(port.readable.getReader(), say);
    this.ask();
    this.stop = () => this.command(scene.entry.actions.stop);
    this.reset = () => this.command(scene.entry.actions.reset);
  }

  async read(reader, say) {
    try {
      for (;;) {
        const { value, done } = await reader.read();
        if (done) break;
        this.waiting.push(value);
      }
      say("The board's port was closed.");
    } catch (error) {
      say(`The board is gone: ${error.message}`);
    }
  }

  write(bytes) {
    return this.writer.write(this.scene.link.slice(0, bytes));
  }

  ask() {
    return this.write(this.scene.c.sp_page_ask());
  }

  // Three times: a frame may be damaged. What it asks first makes the board forget old numbers.
  async command(action) {
    const { watchdog_s, dt_s } = this.scene.entry;
    for (let tries = 0; tries < 3; tries++) {
      await this.ask();
      await this.write(this.scene.c.sp_page_command(action, watchdog_s, 1 / dt_s));
    }
  }
}
