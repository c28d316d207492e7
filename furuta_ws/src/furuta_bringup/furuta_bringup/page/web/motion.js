// The motion over time: its newest rows, how far the arm swings, and what was before the last change.
import { PHI, THETA, TIME } from "./source.js";

const KEPT = 10;  // seconds of rows that are shown
const CAUGHT = 1;  // a pendulum that is upright for so long has not fallen [s]
const LEAST_COUNTS = 2;  // an oscillation below so many encoder counts has no period that means anything
const FAR = 2;  // angle of the arm from which a change begins with a reset [rad]

export class Motion {
  constructor(data, source) {
    this.data = data;
    this.source = source;
    this.rows = [];
    this.since = 0;  // time of the last change [s]
    this.name = "";  // of the settings
    this.was = null;  // name and swing [rad] of those before
    this.before = null;  // the rows before it, and since when they are shown behind the new ones
    this.planned = null;  // a push to come: torques on arm and pendulum [V]
    this.fell = false;
    this.held = null;  // angles of arm and pendulum while a part is held [rad]
    this.moment = null;  // the earlier row that everything shows; meanwhile no row comes
  }

  // The row that is shown.
  get now() {
    return this.moment ?? this.source.now;
  }

  // Shows the moment of the row next to a time; without one, what is now.
  look(time = null) {
    const distance = (row) => Math.abs(row[TIME] - time);
    this.moment = time === null ? null : this.rows.reduce((best, row) => (distance(row) < distance(best) ? row : best), this.rows[0]);
  }

  get time() {
    return this.source.time;
  }

  // Angles of arm and pendulum [rad].
  get pose() {
    return this.held ?? [this.now[PHI], this.now[THETA]];
  }

  get leans() {
    return Math.abs(this.source.now[THETA]) > this.source.fallAngle;
  }

  get hasFallen() {
    return this.fell && !this.source.swingsUp;
  }

  // Seconds until the motion since the last change is measured; a graph may not have sent anything yet.
  get remaining() {
    const passed = this.time - this.since || 0;
    return Math.max(0, this.data.measured.settled - passed);
  }

  // The swing [rad], "fell", or null while it is being measured.
  get result() {
    return this.hasFallen ? "fell" : this.remaining ? null : this.size;
  }

  // The rows of what is measured, which begins with the last change.
  get measured() {
    return this.newest(Math.min(this.data.measured.window, this.time - this.since));
  }

  // The ends of the swing [rad] of the arm, or of the pendulum, in what is measured.
  swing(column = PHI) {
    const angles = this.measured.map((row) => row[column]);
    return angles.length ? [Math.min(...angles), Math.max(...angles)] : [0, 0];
  }

  get size() {
    const [from, to] = this.swing();
    return to - from;
  }

  // The mean time [s] between passages of the arm through its middle, upwards; NaN if it hardly moves.
  get period() {
    const [from, to] = this.swing(), middle = (from + to) / 2, low = middle - (to - from) / 4, passages = [];
    if (to - from < (LEAST_COUNTS * 2 * Math.PI) / (this.source.encoderCounts || Infinity)) return NaN;
    let wasLow = false;
    for (const row of this.measured) {
      if (row[PHI] < low) wasLow = true;
      if (wasLow && row[PHI] >= middle) {
        passages.push(row[TIME]);
        wasLow = false;
      }
    }
    return passages.length > 1 ? (passages.at(-1) - passages[0]) / (passages.length - 1) : NaN;
  }

  newest(seconds = KEPT) {
    const { rows } = this, begin = rows.at(-1)?.[TIME] - seconds;
    let i = Math.max(0, rows.length - 1);
    while (i && rows[i - 1][TIME] > begin) i--;
    return rows.slice(i);
  }

  // Seconds until the push of a step; nothing if there is none.
  get untilPush() {
    return this.planned && this.data.measured.push_after - (this.time - this.since);
  }

  // What comes is measured anew, and the motion so far is kept.
  changed() {
    this.look();
    if (!this.remaining && !this.hasFallen) {
      this.was = { name: this.name, size: this.size };
      this.before = { rows: this.newest(), at: this.time };
    }
    this.since = this.time;
  }

  // Sets values. The pendulum begins anew where the motion before says nothing of that to come.
  turn(values, place) {
    const { source, hasFallen } = this, { swingsUp } = source;
    this.changed();
    source.set(values, place);
    if (hasFallen || swingsUp !== source.swingsUp || Math.abs(source.now[PHI]) > FAR) this.reset();
  }

  // Begins anew at rest, with the arm and the pendulum at these angles [rad].
  reset(phi = 0, theta = undefined) {
    this.source.reset(phi, theta);
    this.planned = null;
    this.begin(this.time);
  }

  // A new motion begins at a time, of which some rows may have come already; who has reset the plant does not matter.
  begin(time, rows = []) {
    Object.assign(this, { rows, since: time, fell: false, moment: null });
    if (this.before) this.before.at = time;
  }

  push(arm, pendulum) {
    this.changed();
    this.planned = null;
    this.source.push(arm, pendulum);
  }

  advance(samples) {
    if (this.moment) return;
    for (const row of this.source.take(samples)) this.add(row);
    if (this.rows.length > 2 * this.newest().length) this.rows = this.newest();
  }

  add(row) {
    const time = row[TIME];
    if (time < this.rows.at(-1)?.[TIME]) this.begin(time);  // another graph
    this.rows.push(row);
    if (this.planned && this.untilPush <= 0) this.push(...this.planned);
    if (this.leans) Object.assign(this, { since: time, fell: true });
    else if (this.source.swingsUp || time - this.since > CAUGHT) this.fell = false;
  }
}
