// Draws the motion: the stage, and one chart in each frame, because charts cost more than they tell.
import { chart } from "./charts.js";
import { F, F_HAT, PHI, SPEED, THETA, TIME, U, wrapped } from "./source.js";
import { Stage } from "./stage.js";

export const DEGREE = Math.PI / 180;
const SHOWN = 10, LEAST = 0.5, PLANE = 5;  // seconds over time, at most and at least, and in the planes
// Smooth edges and pixels, from all details to the fewest.
const DETAILS = [[true, 1], [false, 1], [false, 0.75]];
const USUAL = [0.24, 0.38];  // lengths of arm and pendulum while they are not known [m]
const DRAGGED = 4;  // pixels from which a press is a drag
const LATE = 45;  // a frame that comes later is late [ms]

const AXES = {
  time: "time [s]", phi: "arm angle φ [°]", speed: "arm speed φ̇ [rad/s]", voltage: "voltage [V]", friction: "friction F [V]",
};

const thinned = (rows, most) => {
  const every = Math.max(1, Math.floor(rows.length / most));
  return rows.filter((_, i) => (rows.length - 1 - i) % every === 0);
};
// `about` has the symbol of the values, that of those across, and whether they are angles.
const curve = (rows, x, y, colour, width, about = {}) => ({ x: rows.map(x), y: rows.map(y), colour, width, ...about });
const column = (i) => (row) => row[i];
const before = (now) => (row) => row[TIME] - now;
const angle = (i) => (row) => wrapped(row[i]) / DEGREE;

export class Drawing {
  constructor(host, motion) {
    this.looked = () => {};  // called when another moment is shown
    this.drawn = {};  // rows of the charts
    Object.assign(this, { motion, frames: 0, detail: 0, late: 0, last: 0, fixed: false, seconds: SHOWN, cursors: {} });
    this.charts = ["angles", "voltages", "frictions", "phase"];
    for (const name of this.charts) this.watch(name);
    try {
      this.stage = new Stage(host, true, motion.source.lengths ?? USUAL);
    } catch {
      return;  // no WebGL
    }
    if (this.stage.bySoftware) this.simplify(1);
  }

  // The pointer shows values, and dragged the moment of the point next to it; the wheel changes how many seconds are
  // shown.
  watch(name) {
    const canvas = document.getElementById(name);
    let from = null;
    canvas.onpointerdown = ({ offsetX, pointerId }) => {
      from = offsetX;
      canvas.setPointerCapture(pointerId);
    };
    canvas.onpointerup = canvas.onpointercancel = () => { from = null; };
    canvas.onpointermove = ({ offsetX, offsetY }) => {
      this.cursors[name] = [offsetX, offsetY];
      const point = this[name]();
      if (from === null || point === null || Math.abs(offsetX - from) < DRAGGED) return;
      from = -Infinity;
      this.lookAt(this.drawn[name][point][TIME]);
    };
    canvas.onpointerleave = () => {
      delete this.cursors[name];
      this[name]();
    };
    canvas.addEventListener("wheel", (event) => {
      if (document.documentElement.scrollHeight > innerHeight && !canvas.closest(".large")) return;
      this.seconds = Math.max(LEAST, Math.min(SHOWN, this.seconds * 2 ** (event.deltaY / 400)));
      this[name]();
      event.preventDefault();
    }, { passive: false });
  }

  lookAt(time) {
    this.motion.look(time);
    this.drawAll();
    this.looked();
  }

  frame(now, isStill) {
    if (!isStill || this.frames % 10 === 0) this.drawStage();  // a pause costs little
    if (!isStill || this.frames % 40 < 4) this[this.charts[this.frames % 4]]();
    if (now - this.last > LATE && now - this.last < 500) this.late++;
    this.last = now;
    if (++this.frames % 30 === 0) {
      if (this.late > 15 && !this.fixed && this.stage) this.simplify(this.detail + 1);
      this.late = 0;
    }
  }

  drawAll() {
    this.drawStage();
    for (const name of this.charts) this[name]();
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
    const { now, source: { lengths }, pose } = this.motion, [from, to] = this.motion.swing();
    const [phi, theta] = pose.map((each) => each || 0);  // a graph that has sent nothing yet
    if (lengths) this.stage?.setLengths(lengths);
    this.stage?.draw({ phi, theta, from, to, u: now[U], friction: now[F] });
  }

  // What stands at the values of a quantity under the pointer: its symbol and unit, and those of what is across.
  symbol(name, unit = "V", across = "t", unitAcross = "s") {
    return { symbol: this.motion.data.quantities[name].symbol, unit, across, unitAcross };
  }

  // The rows of a chart, of some seconds.
  rows(name, seconds, most) {
    return (this.drawn[name] = thinned(this.motion.newest(seconds), most));
  }

  // What is marked in a chart: the place of the pointer, and the row of an earlier moment.
  marks(name) {
    const { moment } = this.motion, rows = this.drawn[name], after = rows.findIndex((row) => row[TIME] >= moment?.[TIME]);
    return { cursor: this.cursors[name], at: moment && rows.length ? Math.max(0, after) : null };
  }

  angles() {
    const { seconds, motion } = this, rows = this.rows("angles", seconds, 500), now = motion.time, curves = [];
    const old = motion.before, end = old?.rows.at(-1)?.[TIME] ?? 0;
    if (old) {
      const behind = thinned(old.rows.filter((row) => row[TIME] - end > Math.max(-seconds, old.at - now)), 400);
      curves.push(curve(behind, before(end), angle(PHI), "was", 1.6, { isAngle: true, dash: [5, 4] }));
    }
    curves.push(curve(rows, before(now), angle(THETA), "pendulum", 1.6, { ...this.symbol("pendulum", "°"), isAngle: true }));
    curves.push(curve(rows, before(now), angle(PHI), "arm", 2.2, { ...this.symbol("arm", "°"), isAngle: true }));
    return this.overTime("angles", curves, 5, "angle [°]");
  }

  voltages() {
    const rows = this.rows("voltages", this.seconds, 500), time = before(this.motion.time);
    const looks = [[U, "command", 1.2], [F, "friction", 2.4], [F_HAT, "estimate", 1.4]];
    const curves = looks.map(([i, name, width]) => curve(rows, time, column(i), name, width, this.symbol(name)));
    return this.overTime("voltages", curves, 0.4, AXES.voltage);
  }

  overTime(name, curves, least, title) {
    return chart(name, curves, { across: [-this.seconds, 0], least: { y: least }, axes: [AXES.time, title], ...this.marks(name) });
  }

  frictions() {
    const rows = this.rows("frictions", PLANE, 400), { now } = this.motion;
    const looks = [[F, "friction", 2.4], [F_HAT, "estimate", 1.4]];
    const curves = looks.map(([i, name, width]) => {
      return curve(rows, column(SPEED), column(i), name, width, this.symbol(name, "V", "φ̇", "rad/s"));
    });
    const [i, colour] = Number.isNaN(now[F]) ? looks[1] : looks[0], dot = { x: now[SPEED], y: now[i], colour };
    return this.plane("frictions", curves, { x: 1, y: 0.2 }, [AXES.speed, AXES.friction], dot);
  }

  phase() {
    const rows = this.rows("phase", PLANE, 400), { now, source: { cycle } } = this.motion, orbit = cycle?.orbit ?? [];
    const exact = curve(orbit, ([x]) => x / DEGREE, ([, y]) => y, "was", 6);
    const measured = curve(rows, angle(PHI), column(SPEED), "arm", 1.8, {
      ...this.symbol("arm", "rad/s", "φ", "°"), symbol: "φ̇", isAngle: true,
    });
    const dot = { x: wrapped(now[PHI]) / DEGREE, y: now[SPEED], colour: "arm" };
    return this.plane("phase", [exact, measured], { x: 10, y: 0.5 }, [AXES.phi, AXES.speed], dot);
  }

  plane(name, curves, least, axes, dot) {
    return chart(name, curves, { least, axes, dot, ...this.marks(name) });
  }
}
