// The pointer on the stage: it holds the pendulum or the arm and lets it go at rest, or it turns the view.
import { wrapped } from "./motion.js";

const FASTEST = 0.2;  // most that a held part turns between two events [rad]

// It changes the angles in `signals`; `taken` and `left` are called when a part is taken in the hand and let go.
export class Pointer {
  constructor(host, stage, signals, taken, left) {
    this.held = null;
    const at = (event) => {
      const box = host.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    host.onpointerdown = (event) => {
      if (event.target.id !== "view") return;
      const part = stage.under(at(event), signals[0], signals[2]);
      this.held = { part, at: at(event) };
      event.target.setPointerCapture(event.pointerId);
      event.target.classList.add("holds");
      if (part) taken();
    };
    host.onpointermove = (event) => {
      if (!this.held) return;
      const [x, y] = at(event), { part, at: [x0, y0] } = this.held, { view } = stage;
      if (part) {
        const i = part === "arm" ? 0 : 2, ahead = stage.ahead(part, [x, y], signals[0], signals[2]);
        signals[i] = wrapped(signals[i] + Math.max(-FASTEST, Math.min(FASTEST, ahead)));
      } else {
        view.turn -= (x - x0) / 200;
        view.height = Math.max(0.08, Math.min(1.3, view.height + (y - y0) / 200));
      }
      this.held.at = [x, y];
    };
    // A finger on the pendulum or the arm does not scroll the page.
    host.addEventListener("touchstart", (event) => {
      const [finger] = event.touches;
      if (event.target.id === "view" && stage.under(at(finger), signals[0], signals[2])) event.preventDefault();
    }, { passive: false });
    host.ondblclick = (event) => event.target.id === "view" && stage.lookFromStart();
    host.onpointerup = host.onpointercancel = (event) => {
      const part = this.held?.part;
      this.held = null;
      event.target.classList.remove("holds");
      if (part) left(wrapped(signals[0]), wrapped(signals[2]));
    };
  }
}
