// The compiled loop: turns knobs, runs samples, reads signals.
import { wrapped } from "./source.js";

export const RATE = 1000;  // samples per second
const EVERY = 5;  // a row of so many samples
const PUSH = 100;  // samples
const STEP = 10;  // samples of a single step
const SPEEDS = [["1/10 speed", 0.1], ["1/4 speed", 0.25], ["1/2 speed", 0.5], ["real time", 1], ["2 × speed", 2]];
const START = 0.05;  // angle of the pendulum at the beginning [rad]
const decode = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const numbers = (text) => new Float64Array(decode(text).buffer);

// What Python has put into the page: compressed JSON.
export async function unpacked(text) {
  const stream = new Blob([decode(text)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).json();
}

export class Loop {
  constructor(data) {
    this.data = data;
    const { exports } = new WebAssembly.Instance(new WebAssembly.Module(decode(data.wasm)));
    this.code = exports;
    const view = (address, n) => new Float64Array(exports.memory.buffer, address, n);
    const initial = numbers(data.design);
    this.design = view(exports.design_address(), initial.length);
    this.design.set(initial);
    this.noise = view(exports.noise_address(), 2);
    this.signals = view(exports.signals_address(), 14);
    this.rows = data.groups.map((group) => numbers(group.rows));
    this.knobs = data.knobs;
    this.base = Object.fromEntries(data.knobs.map((knob) => [knob.name, knob.initial]));
    this.values = { ...this.base };
    Object.assign(this, { speeds: SPEEDS, speed: 1, owed: 0, zero: 0, lengths: data.lengths, status: {} });
    Object.assign(this, { isHere: true, hasPlant: true, hasScenes: true, scenesBase: this.base });
    this.set({});
    exports.begin(0, START, 1);
  }

  change({ knobs }) {
    return knobs;
  }

  own(chosen) {
    return { ...this.values, ...chosen };
  }

  // Sets knobs by name; the rows of the table are in the order of their combinations.
  set(values) {
    Object.assign(this.values, values);
    this.data.groups.forEach((group, g) => {
      let row = 0;
      for (const name of group.knobs) {
        const { values: stops } = this.data.knobs.find((knob) => knob.name === name);
        row = row * stops.length + stops.indexOf(this.values[name]);
      }
      const n = group.places.length;
      group.places.forEach((place, i) => { this.design[place] = this.rows[g][row * n + i]; });
      if (g === 0) this.law = group.law[row];
      this.control = group.control[row];
    });
    for (const place of this.data.strength) this.design[place] *= Number(this.values.strength);
  }

  get time() {
    return this.signals[13] / RATE;
  }

  get now() {
    const s = this.signals;
    return [this.time, s[0], s[1], wrapped(s[2]), s[10], s[11], s[12]];
  }

  *take(samples) {
    for (this.owed += samples * this.speed; this.owed >= EVERY; this.owed -= EVERY) {
      this.run(EVERY);
      yield this.now;
    }
  }

  pace(speed) {
    this.speed = speed || this.speed;  // a page that pauses takes nothing
  }

  step() {
    this.owed += STEP;
  }

  get swingsUp() {
    return this.values.mode === "swing up";
  }

  get fallAngle() {
    return this.data.fall_angle;
  }

  get encoderCounts() {
    return this.data.encoder_counts;
  }

  // It is known for the usual settings of all but some knobs.
  get cycle() {
    const varied = ["level", "omega1", "compensation", "believed", "strength", "sensors"];
    const isUsual = this.knobs.every(({ name, initial }) => varied.includes(name) || this.values[name] === initial);
    return isUsual ? this.data.cycles[`${this.values.level} ${this.values.omega1}`] ?? null : undefined;
  }

  // A push that begins now, for so many samples: torques on arm and pendulum [V].
  push(arm, pendulum, samples = PUSH) {
    const now = this.signals[13];
    this.design.set([now, now + samples, arm, pendulum, 0, 0], this.data.pushes);
  }

  // At rest with these angles [rad]; the controller begins anew.
  reset(phi = 0, theta = START) {
    this.code.begin(phi, theta, 0);
    this.design.fill(0, this.data.pushes);
    this.signals.fill(0);
    [this.signals[0], this.signals[2]] = [phi, theta];
    this.owed = 0;
  }

  sample() {
    this.code.sample(this.law, this.control);
  }

  // Samples with noise, by the method of Box and Muller.
  run(samples) {
    for (let k = 0; k < samples; k++) {
      const size = Math.sqrt(-2 * Math.log(1 - Math.random()));
      const angle = 2 * Math.PI * Math.random();
      this.noise[0] = size * Math.cos(angle);
      this.noise[1] = size * Math.sin(angle);
      this.sample();
    }
  }

  // The signals (n, 13) of samples with given noise (n, 2), for comparison.
  replay(noise) {
    const out = new Float64Array((noise.length / 2) * 13);
    for (let k = 0; k < noise.length / 2; k++) {
      this.noise.set(noise.subarray(2 * k, 2 * k + 2));
      this.sample();
      out.set(this.signals.subarray(0, 13), 13 * k);
    }
    return out;
  }
}
