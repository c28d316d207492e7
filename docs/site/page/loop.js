// The compiled loop: turns knobs, runs samples, reads signals.
export const RATE = 1000;  // samples per second
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
    this.knobs = Object.fromEntries(data.knobs.map((knob) => [knob.name, knob.initial]));
    this.turn({});
    exports.begin(0, START, 1);
  }

  // Sets knobs by name; the rows of the table are in the order of their combinations.
  turn(knobs) {
    Object.assign(this.knobs, knobs);
    this.data.groups.forEach((group, g) => {
      let row = 0;
      for (const name of group.knobs) {
        const { values } = this.data.knobs.find((knob) => knob.name === name);
        row = row * values.length + values.indexOf(this.knobs[name]);
      }
      const n = group.places.length;
      group.places.forEach((place, i) => { this.design[place] = this.rows[g][row * n + i]; });
      if (g === 0) this.law = group.law[row];
      this.control = group.control[row];
    });
    for (const place of this.data.strength) this.design[place] *= Number(this.knobs.strength);
  }

  get time() {
    return this.signals[13] / RATE;
  }

  // A push that begins now, for so many samples: torques on arm and pendulum [V].
  push(samples, arm, pendulum) {
    const now = this.signals[13];
    this.design.set([now, now + samples, arm, pendulum, 0, 0], this.data.pushes);
  }

  // At rest with these angles [rad]; the controller begins anew.
  putBack(phi = 0, theta = START) {
    this.code.begin(phi, theta, 0);
    this.design.fill(0, this.data.pushes);
    this.signals.fill(0);
    [this.signals[0], this.signals[2]] = [phi, theta];
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
