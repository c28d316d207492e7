// Draws the motion: the stage, and one chart in each frame, because charts cost more than they tell.
import { chart } from "./charts.js";
import { F, F_HAT, PHI, SPEED, THETA, TIME, U, turns, wrapped } from "./motion.js";
import { Stage } from "./stage.js";

export const DEGREE = Math.PI / 180;
const SHOWN = 10, PLANE = 5;  // seconds over time and in the planes
// Smooth edges and pixels, from all details to the fewest.
const DETAILS = [[true, 1], [false, 1], [false, 0.75]];
const LATE = 45;  // a frame that comes later is late [ms]

const thinned = (rows, most) => rows.filter((_, i) => (rows.length - 1 - i) % Math.max(1, Math.floor(rows.length / most)) === 0);
const curve = (rows, x, y, colour, width) => ({ x: rows.map(x), y: rows.map(y), colour, width });
const column = (i) => (row) => row[i];
const before = (now) => (row) => row[TIME] - now;
// Angles in degrees; whole turns of the arm until the last row do not count.
const angle = (rows, i) => {
  const past = turns(rows.at(-1)?.[i] ?? 0);
  return (row) => (row[i] - past) / DEGREE;
};

export class Drawing {
  // `cycle` gives the exact cycle of the settings, if there is one.
  constructor(host, motion, cycle) {
    Object.assign(this, { motion, cycle, frames: 0, detail: 0, late: 0, last: 0, fixed: false });
    this.charts = [this.angles, this.voltages, this.frictions, this.phase];
    try {
      this.stage = new Stage(host, true);
    } catch {
      return;  // no WebGL
    }
    if (this.stage.bySoftware) this.simplify(1);
  }

  frame(now, isStill) {
    if (!isStill || this.frames % 10 === 0) this.drawStage();  // a pause costs little
    if (!isStill || this.frames % 40 < 4) this.charts[this.frames % 4].call(this);
    if (now - this.last > LATE && now - this.last < 500) this.late++;
    this.last = now;
    if (++this.frames % 30 === 0) {
      if (this.late > 15 && !this.fixed && this.stage) this.simplify(this.detail + 1);
      this.late = 0;
    }
  }

  drawAll() {
    this.drawStage();
    for (const draws of this.charts) draws.call(this);
  }

  // Fewer details where frames come late; or these ones for ever.
  simplify(level, fixed = false) {
    this.fixed = fixed;
    const earlier = DETAILS[this.detail];
    this.detail = Math.min(level, DETAILS.length - 1);
    const [smooth, pixels] = DETAILS[this.detail];
    if (smooth !== earlier[0]) this.stage.renew(smooth);
    this.stage.detail = pixels;
  }

  drawStage() {
    const { loop, swing: [from, to] } = this.motion, s = loop.signals;
    this.stage?.draw({ phi: s[0], theta: s[2], from, to, u: s[12], friction: s[10] });
  }

  angles() {
    const rows = thinned(this.motion.newest(SHOWN), 500), now = this.motion.loop.time, curves = [];
    const old = this.motion.before, end = old?.rows.at(-1)?.[TIME] ?? 0;
    if (old) {
      const behind = thinned(old.rows.filter((row) => row[TIME] - end > Math.max(-SHOWN, old.at - now)), 400);
      curves.push(curve(behind, before(end), angle(old.rows, PHI), "was", 1.6));
    }
    curves.push(curve(rows, before(now), angle(rows, THETA), "pendulum", 1.6), curve(rows, before(now), angle(rows, PHI), "arm", 2.2));
    chart("angles", curves, { across: [-SHOWN, 0], least: { y: 5 }, units: ["s", "°"] });
  }

  voltages() {
    const rows = thinned(this.motion.newest(SHOWN), 500), time = before(this.motion.loop.time);
    const curves = [[U, "command", 1.2], [F, "friction", 2.4], [F_HAT, "estimate", 1.4]];
    chart("voltages", curves.map(([i, ...look]) => curve(rows, time, column(i), ...look)), { across: [-SHOWN, 0], least: { y: 0.4 }, units: ["s", "V"] });
  }

  frictions() {
    const rows = thinned(this.motion.newest(PLANE), 400), s = this.motion.loop.signals;
    const curves = [[F, "friction", 2.4], [F_HAT, "estimate", 1.4]].map(([i, ...look]) => curve(rows, column(SPEED), column(i), ...look));
    chart("frictions", curves, { least: { x: 1, y: 0.2 }, units: ["rad/s", "V"], dot: { x: s[1], y: s[10], colour: "friction" } });
  }

  phase() {
    const rows = thinned(this.motion.newest(PLANE), 400), s = this.motion.loop.signals, orbit = this.cycle()?.orbit ?? [];
    const exact = curve(orbit, ([x]) => x / DEGREE, ([, y]) => y, "was", 6);
    const dot = { x: wrapped(s[0]) / DEGREE, y: s[1], colour: "arm" };
    chart("phase", [exact, curve(rows, angle(rows, PHI), column(SPEED), "arm", 1.8)], { least: { x: 10, y: 0.5 }, units: ["°", "rad/s"], dot });
  }
}
