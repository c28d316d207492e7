// The motion of the loop over time: its newest samples, how far the arm swings, and what was before the last change.
import { Loop, RATE } from "./loop.js";

const EVERY = 5;  // a row of so many samples
const KEPT = 10;  // seconds of rows that are shown
const CAUGHT = 1;  // a pendulum that is upright for so long has not fallen [s]
// Columns of a row: time [s], arm angle and speed, pendulum, friction, its estimate, voltage.
export const TIME = 0, PHI = 1, SPEED = 2, THETA = 3, F = 4, F_HAT = 5, U = 6;

export const turns = (angle) => 2 * Math.PI * Math.round(angle / (2 * Math.PI));
export const wrapped = (angle) => angle - turns(angle);

export class Motion {
  constructor(data) {
    this.data = data;
    this.loop = new Loop(data);
    this.rows = [];
    this.since = 0;  // time of the last change [s]
    this.name = "";  // of the settings
    this.was = null;  // name and swing [rad] of those before
    this.before = null;  // the rows before it, and since when they are shown behind the new ones
    this.planned = null;  // a push to come: torques on arm and pendulum [V]
    this.fell = false;
    this.owed = 0;
  }

  get swingsUp() {
    return this.loop.knobs.mode === "swing up";
  }

  get leans() {
    return Math.abs(wrapped(this.loop.signals[2])) > this.data.fall_angle;
  }

  get hasFallen() {
    return this.fell && !this.swingsUp;
  }

  // Seconds until the motion since the last change is measured.
  get remaining() {
    return Math.max(0, this.data.measured.settled - (this.loop.time - this.since));
  }

  // The swing [rad], "fell", or null while it is being measured.
  get result() {
    return this.hasFallen ? "fell" : this.remaining ? null : this.size;
  }

  // The ends of the arm's swing [rad] in what is measured, which begins with the last change.
  get swing() {
    const { window } = this.data.measured;
    const angles = this.newest(Math.min(window, this.loop.time - this.since)).map((row) => row[PHI]);
    return angles.length ? [Math.min(...angles), Math.max(...angles)] : [0, 0];
  }

  get size() {
    const [from, to] = this.swing;
    return to - from;
  }

  newest(seconds = KEPT) {
    return this.rows.slice(-Math.max(1, Math.round((seconds * RATE) / EVERY)));
  }

  // Seconds until the push of a step; nothing if there is none.
  get untilPush() {
    return this.planned && this.data.measured.push_after - (this.loop.time - this.since);
  }

  // What comes is measured anew, and the motion so far is kept.
  changed() {
    if (!this.remaining && !this.hasFallen) {
      this.was = { name: this.name, size: this.size };
      this.before = { rows: this.newest(), at: this.loop.time };
    }
    this.since = this.loop.time;
  }

  // Sets knobs. The pendulum begins anew where the motion before says nothing of that to come.
  turn(knobs) {
    const { hasFallen, swingsUp } = this;
    this.changed();
    this.loop.turn(knobs);
    if (hasFallen || swingsUp !== this.swingsUp || Math.abs(this.loop.signals[0]) > 2) this.reset();
  }

  // Begins anew at rest, with the arm and the pendulum at these angles [rad].
  reset(phi = 0, theta = undefined) {
    this.loop.putBack(phi, theta);
    Object.assign(this, { rows: [], since: 0, planned: null, fell: false, owed: 0 });
    if (this.before) this.before.at = 0;
  }

  push(arm, pendulum) {
    this.changed();
    this.planned = null;
    this.loop.push(100, arm, pendulum);
  }

  advance(samples) {
    for (this.owed += samples; this.owed >= EVERY; this.owed -= EVERY) {
      this.loop.run(EVERY);
      const s = this.loop.signals, { time } = this.loop;
      this.rows.push([time, s[0], s[1], wrapped(s[2]), s[10], s[11], s[12]]);
      if (this.planned && this.untilPush <= 0) this.push(...this.planned);
      if (this.leans) Object.assign(this, { since: time, fell: true });
      else if (this.swingsUp || time - this.since > CAUGHT) this.fell = false;
    }
    if (this.rows.length > (2 * KEPT * RATE) / EVERY) this.rows = this.newest();
  }
}
