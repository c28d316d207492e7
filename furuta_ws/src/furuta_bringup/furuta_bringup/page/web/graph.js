// A running graph, by the server of `furuta view`: rows as numbers, all else as JSON.
import { COLUMNS, F_HAT, PHI, THETA, TIME } from "./source.js";

const AGAIN = 1000;  // between attempts to connect [ms]
const MOST = 4000, KEPT = 1200;  // rows that wait for a page that does not draw, and those that it then gets
const SPEEDS = [
  ["1/10 speed", 0.1], ["1/4 speed", 0.25], ["1/2 speed", 0.5], ["real time", 1], ["2 × speed", 2], ["5 × speed", 5],
  ["as fast as possible", null],
];

export class Graph {
  constructor(data) {
    Object.assign(this, { data, knobs: [], values: {}, base: {}, rows: [], status: {}, cycle: undefined, zero: 0 });
    this.touched = new Set(data.names);
    this.asked = new Map();  // numbers that have been sent and not yet confirmed, by name
    this.now = Array(COLUMNS).fill(NaN);
  }

  // Connects; `told` is called with each message, when it has been taken in.
  connect(told) {
    this.told = told;
    this.socket = new WebSocket(`ws://${location.host}`);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = ({ data }) => {
      if (typeof data === "string") this.hear(JSON.parse(data));
      else this.receive(new Float64Array(data));
    };
    this.socket.onclose = () => {
      this.hear({ status: { lost: true } });
      setTimeout(() => this.connect(told), AGAIN);
    };
  }

  // A hidden page draws nothing, so its rows would pile up.
  receive(numbers) {
    for (let i = 0; i < numbers.length; i += COLUMNS) this.rows.push([...numbers.subarray(i, i + COLUMNS)]);
    if (this.rows.length > MOST) this.rows.splice(0, this.rows.length - KEPT);
  }

  hear(message) {
    if (message.nodes) {
      Object.assign(this, { knobs: message.nodes, values: {} });
      this.asked.clear();
    }
    this.receiveValues(message);
    for (const key of ["base", "status", "cycle", "zero", "lengths"]) if (key in message) this[key] = message[key];
    if (message.began) {
      const [time, phi, theta] = message.began;
      this.rows = this.rows.filter((row) => row[TIME] >= time);
      const first = Object.assign(Array(COLUMNS).fill(0), { [TIME]: time, [PHI]: phi, [THETA]: theta, [F_HAT]: NaN });
      if (!(this.time > time)) this.now = first;
    }
    this.told(message);
  }

  // An older value does not take back what the user has chosen since, unless the newer one has been refused.
  receiveValues({ values = {}, failed }) {
    for (const [name, value] of Object.entries(values)) {
      if (failed || this.asked.get(name) === value) this.asked.delete(name);
      if (!this.asked.has(name)) this.values[name] = value;
    }
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  get hasPlant() {
    return Object.keys(this.values).some((name) => name.startsWith("plant."));
  }

  get hasScenes() {
    return this.data.names.every((name) => name in this.values);
  }

  get scenesBase() {
    return Object.fromEntries(this.data.names.map((name) => [name, this.base[name]]));
  }

  change({ settings = {}, times = {} }) {
    const multiplied = Object.entries(times).map(([name, factor]) => [name, factor * this.base[name]]);
    return { ...settings, ...Object.fromEntries(multiplied) };
  }

  set(values, place) {
    for (const [name, value] of Object.entries(values)) {
      this.touched.add(name);
      if (typeof value === "number" && value !== this.values[name]) this.asked.set(name, value);
    }
    Object.assign(this.values, values);  // a node that refuses one tells which it has
    this.send({ set: values, place });
  }

  own(chosen) {
    const names = [...this.touched].filter((name) => name in this.values);
    return { ...Object.fromEntries(names.map((name) => [name, this.values[name]])), ...chosen };
  }

  get time() {
    return this.now[TIME];
  }

  *take() {
    for (const row of this.rows.splice(0)) yield (this.now = row);
  }

  push(arm, pendulum) {
    for (const [name, size] of [["pushes.arm", arm], ["pushes.pendulum", pendulum]]) if (size) this.send({ push: name, size });
  }

  reset(phi = 0, theta = undefined) {
    this.send(theta === undefined ? { reset: true } : { put: [phi, theta] });
  }

  pace(speed) {
    this.send({ speed });
  }

  step() {
    this.send({ step: true });
  }

  get speeds() {
    return this.status.title === "lock-step" ? SPEEDS : [];
  }

  get swingsUp() {
    return this.values["controller.mode"] === "swing_up";
  }

  get fallAngle() {
    return this.values["controller.fall_angle"] ?? Infinity;
  }

  get encoderCounts() {
    return this.values["estimator.sensors.encoder_counts"];
  }
}
