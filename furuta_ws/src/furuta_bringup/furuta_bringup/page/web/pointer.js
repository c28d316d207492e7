// The pointer on the stage: it holds the pendulum or the arm and lets it go at rest, or it turns the view.
import { wrapped } from "./source.js";

const FASTEST = 0.2;  // most that a held part turns between two events [rad]

// It sets `motion.held`; `taken` and `left` are called when a part is taken in the hand and let go.
export class Pointer {
  constructor(host, stage, motion, taken, left) {
    this.held = null;
    const at = (event) => {
      const box = host.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    host.onpointerdown = (event) => {
      if (event.target.id !== "view") return;
      const part = motion.source.hasPlant && stage.under(at(event), ...motion.pose);
      this.held = { part, at: at(event) };
      if (part) motion.held = motion.pose.map(wrapped);
      event.target.setPointerCapture(event.pointerId);
      event.target.classList.add("holds");
      if (part) taken();
    };
    host.onpointermove = (event) => {
      if (!this.held) return;
      const [x, y] = at(event), { part, at: [x0, y0] } = this.held, { view } = stage;
      if (part) {
        const i = part === "arm" ? 0 : 1, ahead = stage.ahead(part, [x, y], ...motion.held);
        motion.held[i] = wrapped(motion.held[i] + Math.max(-FASTEST, Math.min(FASTEST, ahead)));
      } else {
        view.turn -= (x - x0) / 200;
        view.height = Math.max(0.08, Math.min(1.3, view.height + (y - y0) / 200));
      }
      this.held.at = [x, y];
    };
    // A finger on the pendulum or the arm does not scroll the page.
    host.addEventListener("touchstart", (event) => {
      const [finger] = event.touches;
      if (event.target.id === "view" && motion.source.hasPlant && stage.under(at(finger), ...motion.pose)) event.preventDefault();
    }, { passive: false });
    // Where the page scrolls, the wheel and two fingers are for that.
    host.addEventListener("wheel", (event) => {
      if (event.target.id !== "view" || document.documentElement.scrollHeight > innerHeight) return;
      stage.zoom(2 ** (event.deltaY / 500));
      event.preventDefault();
    }, { passive: false });
    host.ondblclick = (event) => event.target.id === "view" && stage.lookFromStart();
    host.onpointerup = host.onpointercancel = (event) => {
      const part = this.held?.part, angles = motion.held;
      this.held = motion.held = null;
      event.target.classList.remove("holds");
      if (part) left(...angles);
    };
  }
}
