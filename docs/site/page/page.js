// The page: drawing, charts, scenes and controls around the compiled loop.
const DATA = JSON.parse(document.getElementById("data").textContent);
const RATE = 1000, SHOWN = 10 * RATE, EVERY = 5, MEASURED = 5 * RATE, SETTLED = 8 * RATE;
const ARM = "#0072b2", PENDULUM = "#d55e00", FRICTION = "#000000", ESTIMATE = "#009e73", COMMAND = "#56b4e9";
// Columns of the history: arm angle and speed, pendulum, friction, its estimate, command.
const PHI = 0, SPEED = 1, THETA = 2, F = 3, F_HAT = 4, U = 5;
const $ = (id) => document.getElementById(id);
const loop = new Loop(DATA);
// What each step has measured, by scene and step. It is measured until the reader changes something.
const results = {};
let history = [], paused = false, speed = 1, owed = 0, scene = 0, step = 0, measuring = true, planned = null;
let last = performance.now(), frames = 0;

function forget() {
  history = [];
  owed = 0;
}

function reset() {
  loop.putBack();
  forget();
}

function advance(samples) {
  for (; samples > 0; samples -= EVERY) {
    loop.run(EVERY);
    const s = loop.signals;
    if (planned !== null && s[13] >= planned.at) {
      loop.push(100, planned.arm, planned.pendulum);
      planned = null;
    }
    history.push([s[0], s[1], wrapped(s[2]), s[10], s[11], s[12]]);
  }
  if (history.length > SHOWN / EVERY) history = history.slice(-SHOWN / EVERY);
}

function wrapped(angle) {
  return angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
}

function hasFallen() {
  return Math.abs(wrapped(loop.signals[2])) > DATA.fall_angle && loop.knobs.mode !== "swing up";
}

function prepared(canvas) {
  const scale = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
  if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
  const c = canvas.getContext("2d");
  c.setTransform(scale, 0, 0, scale, 0, 0);
  c.clearRect(0, 0, width, height);
  return [c, width, height];
}

function line(c, points, color, width = 1.5, dash = []) {
  c.beginPath();
  c.strokeStyle = color;
  c.lineWidth = width;
  c.setLineDash(dash);
  points.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)));
  c.stroke();
}

// Axes for values within ±limits; returns what turns values into pixels.
function axes(c, width, height, across, up, zero) {
  const x = (v) => 40 + (width - 50) * (zero ? (v + across) / (2 * across) : v / across);
  const y = (v) => (height - 18) / 2 * (1 - v / up) + 2;
  c.font = "11px sans-serif";
  c.fillStyle = "#333";
  for (const v of [-0.8 * up, 0, 0.8 * up]) {
    line(c, [[40, y(v)], [width - 10, y(v)]], "#ddd", 1);
    c.fillText(Number(v.toPrecision(2)), 2, y(v) + 4);
  }
  const marks = zero ? [-0.8 * across, 0, 0.8 * across] : [0, across / 2, across];
  for (const v of marks) {
    c.fillText(zero ? Number(v.toPrecision(2)) : `${v - across} s`, Math.min(x(v), width - 28), height - 3);
  }
  return [x, y];
}

function rounded(limit) {
  return [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find((each) => each >= limit) || 100;
}

function extent(...columns) {
  let largest = 0;
  for (const row of history) for (const i of columns) largest = Math.max(largest, Math.abs(row[i]));
  return largest;
}

function overTime(id, columns) {
  const [c, width, height] = prepared($(id));
  const [x, y] = axes(c, width, height, 10, 1.1 * rounded(extent(...columns.map(([i]) => i))), false);
  const from = SHOWN / EVERY - history.length;
  for (const [i, color, dash, width] of columns) {
    line(c, history.map((row, k) => [x((from + k) * EVERY / RATE), y(row[i])]), color, width, dash);
  }
}

function cycle() {
  const { knobs } = loop;
  const plain = ["level", "stiffness"].every((name) => knobs[name] === "1") && knobs.law === "lugre"
    && knobs.belt === "0" && knobs.mode === "balance";
  return plain ? DATA.cycles[knobs.omega1] : undefined;
}

// Curves over the last seconds in a plane; a curve is rows, two columns, color and width.
function plane(id, curves) {
  const [c, width, height] = prepared($(id));
  const most = (k) => Math.max(...curves.map(([rows, ...i]) => Math.max(0, ...rows.map((row) => Math.abs(row[i[k]])))));
  const [x, y] = axes(c, width, height, rounded(most(0)), 1.1 * rounded(most(1)), true);
  for (const [rows, i, k, color, thick] of curves) line(c, rows.map((row) => [x(row[i]), y(row[k])]), color, thick);
}

// Perspective from above: x to the right, y away, z up; lengths in arm lengths.
function draw() {
  const [c, width, height] = prepared($("drawing"));
  const scale = height / 3.6;
  const at = ([x, y, z]) => {
    const far = 7 + 0.9 * y - 0.35 * z;
    return [width / 2 + scale * 7 * x / far, height * 0.5 - scale * 7 * (0.9 * z + 0.35 * y) / far];
  };
  const [phi, , theta] = loop.signals;
  const [cos, sin] = [Math.cos(phi - 0.9), Math.sin(phi - 0.9)];
  const joint = [cos, sin, 0], l = 1.3;
  const tip = [cos - l * Math.sin(theta) * sin, sin + l * Math.sin(theta) * cos, l * Math.cos(theta)];
  const circle = Array.from({ length: 61 }, (_, i) => [Math.cos(i * Math.PI / 30), Math.sin(i * Math.PI / 30), 0]);
  line(c, circle.map(at), "#ddd", 1);
  line(c, [at([0, 0, -1.2]), at([0, 0, 0])], "#666", 12);
  line(c, [at([0, 0, 0]), at(joint)], ARM, 8);
  line(c, [at(joint), at(tip)], PENDULUM, 6);
  c.beginPath();
  c.fillStyle = PENDULUM;
  c.arc(...at(tip), 9, 0, 7);
  c.fill();
}

function measured() {
  const part = history.slice(-MEASURED / EVERY);
  const range = (i) => Math.max(...part.map((row) => row[i])) - Math.min(...part.map((row) => row[i]));
  return part.length < 2 ? [0, 0] : [range(PHI), range(THETA)];
}

function tell() {
  const [arm, pendulum] = measured();
  const known = cycle();
  const predicted = known && loop.knobs.compensation === "none"
    ? ` Predicted without compensation: exact cycle ${known.exact.toFixed(3)} rad, describing function ${known.predicted.toFixed(3)} rad.` : "";
  $("state").textContent = `${(loop.signals[13] / RATE).toFixed(1)} s. Peak to peak in the last 5 s: arm ${arm.toFixed(3)} rad, `
    + `pendulum ${pendulum.toFixed(3)} rad.${predicted}`;
  $("fallen").hidden = !hasFallen();
  if (measuring && hasFallen()) results[[scene, step]] = "fallen";
  else if (measuring && loop.signals[13] > SETTLED) results[[scene, step]] = `${arm.toFixed(3)} rad`;
  document.querySelectorAll("[data-step]").forEach((cell) => { cell.textContent = results[[scene, cell.dataset.step]] || "…"; });
}

function show() {
  draw();
  overTime("angles", [[PHI, ARM, [], 1.5], [THETA, PENDULUM, [5, 2], 1.5]]);
  overTime("voltages", [[U, COMMAND, [], 1], [F, FRICTION, [], 2.5], [F_HAT, ESTIMATE, [], 1.2]]);
  const newest = history.slice(-MEASURED / EVERY);
  plane("frictions", [[newest, SPEED, F, FRICTION, 3], [newest, SPEED, F_HAT, ESTIMATE, 1.2]]);
  plane("phase", [[(cycle() || { orbit: [] }).orbit, 0, 1, "#999", 4], [newest, PHI, SPEED, ARM, 1.2]]);
}

function frame(now) {
  owed += Math.min(now - last, 100) * speed * RATE / 1000;
  last = now;
  if (!paused) advance(Math.floor(owed / EVERY) * EVERY);
  owed = paused ? 0 : owed % EVERY;
  show();
  if (++frames % 10 === 0) tell();
  requestAnimationFrame(frame);
}

function setKnobs(knobs) {
  loop.turn(knobs);
  for (const [name, value] of Object.entries(loop.knobs)) $(`knob-${name}`).value = value;
}

function enter(newScene, newStep) {
  [scene, step] = [newScene, newStep];
  const told = DATA.scenes[scene], { knobs, push } = told.steps[step];
  const initial = Object.fromEntries(DATA.knobs.map((knob) => [knob.name, knob.initial]));
  setKnobs({ ...initial, ...knobs });
  reset();
  measuring = true;
  delete results[[scene, step]];
  planned = push ? { at: 2 * RATE, arm: push["pushes.arm"] || 0, pendulum: push["pushes.pendulum"] || 0 } : null;
  tellScene();
}

function tellScene() {
  const told = DATA.scenes[scene], { name, look } = told.steps[step];
  const element = (tag, text, kind = "") => Object.assign(document.createElement(tag), { textContent: text, className: kind });
  const button = (text, action) => Object.assign(element("button", text), { onclick: action });
  const choice = element("select", "");
  choice.setAttribute("aria-label", "Scene");
  DATA.scenes.forEach((each, i) => choice.add(new Option(`${i + 1} ${each.title}`, i, false, i === scene)));
  choice.onchange = () => enter(Number(choice.value), 0);
  const next = step + 1 < told.steps.length ? [scene, step + 1] : [(scene + 1) % DATA.scenes.length, 0];
  const table = element("table", "");
  told.steps.forEach((each, i) => {
    const result = element("td", "…");
    result.dataset.step = i;
    table.insertRow().append(element("th", (i === step ? "▸ " : "") + each.name), result);
  });
  table.createCaption().textContent = "Arm peak to peak, measured after 8 s";
  $("scene").replaceChildren(
    element("h2", "Guided scenes"), choice, " ",
    button(next[0] === scene ? "Next step (N)" : "Next scene (N)", () => enter(...next)), " ",
    ...(step ? [button("Back", () => enter(scene, step - 1)), " "] : []), button("Free play", freePlay),
    element("p", told.text), element("p", `Step ${step + 1} of ${told.steps.length}, ${name}. ${look}`, "look"), table,
  );
}

function freePlay() {
  measuring = false;
  const back = Object.assign(document.createElement("button"), { textContent: "Back to the scenes (N)", onclick: () => enter(scene, step) });
  $("scene").replaceChildren(back);
}

function makeKnobs() {
  const text = (tag, words) => Object.assign(document.createElement(tag), { textContent: words });
  $("knobs").append(text("h2", "Parameters"));
  for (const { name, title, meaning, values } of DATA.knobs) {
    const row = Object.assign(document.createElement("div"), { className: "knob" });
    const label = Object.assign(text("label", title), { htmlFor: `knob-${name}` });
    const choice = Object.assign(document.createElement("select"), { id: `knob-${name}` });
    values.forEach((value) => choice.add(new Option(value)));
    choice.onchange = () => {
      measuring = false;
      setKnobs({ [name]: choice.value });
    };
    row.append(label, choice, text("small", meaning));
    $("knobs").append(row);
  }
}

function pause() {
  paused = !paused;
  $("pause").textContent = paused ? "Go on (space)" : "Pause (space)";
}

makeKnobs();
$("pause").onclick = pause;
$("reset").onclick = $("again").onclick = reset;
$("speed").onchange = (event) => { speed = Number(event.target.value); };
for (const button of document.querySelectorAll("[data-arm], [data-pendulum]")) {
  button.onclick = () => loop.push(100, Number(button.dataset.arm || 0), Number(button.dataset.pendulum || 0));
}
document.onkeydown = (event) => {
  if (["SELECT", "BUTTON"].includes(event.target.tagName) && event.key === " ") return;
  const keys = { " ": pause, r: reset, n: () => $("scene").querySelector("button").click() };
  const arrows = { ArrowLeft: -2, ArrowRight: 2 };
  if (event.target.tagName !== "SELECT" && event.key in arrows) loop.push(100, arrows[event.key], 0);
  else if (!event.ctrlKey && !event.metaKey && event.key in keys) keys[event.key]();
  else return;
  event.preventDefault();
};
enter(0, 0);
requestAnimationFrame(frame);
