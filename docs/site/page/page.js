// The page: scenes, controls, pointer and keys around the compiled loop, its stage and its charts.
import { chart, forgetColours, text } from "./charts.js";
import { Loop, RATE, unpacked } from "./loop.js";
import { numbersFile, pictureFile } from "./files.js";
import { Stage } from "./stage.js";

const DATA = await unpacked(document.getElementById("data").textContent);
const EVERY = 5, SHOWN = 10, DEGREE = Math.PI / 180, PLANE = 5;
const { push_after: PUSH_AFTER, settled: SETTLED, window: WINDOW } = DATA.measured;
const PUSHES = { arm: 2, pendulum: 0.3 };  // for 0.1 s [V]
const LONG_BAR = 5 * DEGREE;  // a swing whose bar may fill its line
const SPEEDS = { "¼": 0.25, "½": 0.5, "1×": 1, "2×": 2 };
const PAUSE = '<svg viewBox="0 0 16 16"><rect x="3" y="2" width="4" height="12" rx="1"/><rect x="9" y="2" width="4" height="12" rx="1"/></svg>';
const PLAY = '<svg viewBox="0 0 16 16"><path d="M4 2v12l10-6z"/></svg>';
// Columns of the history: time [s], arm angle and speed, pendulum, friction, its estimate, voltage.
const TIME = 0, PHI = 1, SPEED = 2, THETA = 3, F = 4, F_HAT = 5, U = 6;

const $ = (id) => document.getElementById(id);
const make = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};
const loop = new Loop(DATA);
const knobOf = Object.fromEntries(DATA.knobs.map((knob) => [knob.name, knob]));
const initial = Object.fromEntries(DATA.knobs.map((knob) => [knob.name, knob.initial]));
// The swing of each step [rad], or "fell".
const results = DATA.scenes.map((scene) => scene.steps.map(() => null));
const state = { scene: 0, step: 0, paused: false, speed: 1, since: 0, was: null, before: null, push: null, held: null, side: 1, fell: false };
let history = [], owed = 0, last = performance.now();

const turns = (angle) => 2 * Math.PI * Math.round(angle / (2 * Math.PI));
const wrapped = (angle) => angle - turns(angle);
const leans = () => Math.abs(wrapped(loop.signals[2])) > DATA.fall_angle;
const hasFallen = () => state.fell && loop.knobs.mode !== "swing up";
const remaining = () => Math.max(0, SETTLED - (loop.time - state.since));
const isStep = () => state.step !== null;
const newest = (seconds) => history.slice(-Math.round((seconds * RATE) / EVERY));

// The ends of the arm's swing in what is measured [rad].
function swing() {
  const angles = newest(WINDOW).map((row) => row[PHI]);
  return angles.length ? [Math.min(...angles), Math.max(...angles)] : [0, 0];
}

const size = () => swing()[1] - swing()[0];

function degrees(radians) {
  const value = radians / DEGREE;
  return `${text(value, value < 3 ? 2 : 1)}°`;
}

function counts(radians) {
  const n = (radians * DATA.encoder_counts) / (2 * Math.PI);
  if (n < 0.95) return "less than one encoder count";
  return n < 1.05 ? "one encoder count" : `${n.toFixed(n < 9.5 ? 1 : 0)} encoder counts`;
}

// Something has changed: what comes is measured anew, and the motion so far is shown in grey.
function changed() {
  if (!remaining() && !hasFallen()) {
    state.was = size();
    state.before = { rows: history, at: loop.time };
  } else if (state.before) state.before.at = Math.max(state.before.at, state.since);
  state.since = loop.time;
}

// Begins anew at rest, with the arm and the pendulum at these angles [rad].
function reset(phi = 0, theta = undefined) {
  loop.putBack(phi, theta);
  Object.assign(state, { since: 0, push: null, fell: false });
  if (state.before) state.before.at = 0;
  history = [];
  owed = 0;
}

function push(arm, pendulum) {
  changed();
  loop.push(100, arm, pendulum);
}

function advance(samples) {
  for (; samples >= EVERY; samples -= EVERY) {
    loop.run(EVERY);
    const s = loop.signals;
    history.push([loop.time, s[0], s[1], wrapped(s[2]), s[10], s[11], s[12]]);
    if (state.fell && !leans() && loop.knobs.mode === "swing up") state.fell = false;
    if (state.push && loop.time - state.since >= PUSH_AFTER) {
      push(...state.push);
      state.push = null;
    }
    if (leans()) Object.assign(state, { since: loop.time, fell: true });
  }
  if (history.length > (2 * SHOWN * RATE) / EVERY) history = newest(SHOWN);
}

// Knobs and scenes

function setKnobs(knobs) {
  const fell = hasFallen(), { mode } = loop.knobs;
  changed();
  loop.turn(knobs);
  if (fell || mode !== loop.knobs.mode || Math.abs(loop.signals[0]) > 2) reset();
  showKnobs();
}

// The user's own setting: no step of a scene.
function choose(knobs) {
  Object.assign(state, { step: null, push: null });
  setKnobs(knobs);
  showScene();
}

function enter(scene, step) {
  const { knobs, push: pushed } = DATA.scenes[scene].steps[step];
  Object.assign(state, { scene, step });
  setKnobs({ ...initial, ...knobs });
  state.push = pushed ? [pushed["pushes.arm"] || 0, pushed["pushes.pendulum"] || 0] : null;
  results[scene][step] = null;
  showScene();
}

function next() {
  const { steps } = DATA.scenes[state.scene], step = (state.step ?? -1) + 1;
  enter(...(step < steps.length ? [state.scene, step] : [(state.scene + 1) % DATA.scenes.length, 0]));
}

function back() {
  const { scene, step } = state;
  if (step) enter(scene, step - 1);
  else if (scene) enter(scene - 1, DATA.scenes[scene - 1].steps.length - 1);
}

function measured() {
  return hasFallen() ? "fell" : remaining() ? null : size();
}

function said(result) {
  return result === "fell" ? result : degrees(result);
}

function waiting() {
  if (loop.knobs.mode === "swing up" && leans()) return "swinging up";
  return `measuring: ${Math.ceil(remaining())} s`;
}

const cycle = () => {
  const { knobs } = loop;
  const others = DATA.knobs.filter(({ name }) => !["level", "omega1", "compensation", "believed", "strength", "sensors"].includes(name));
  return others.every(({ name, initial: usual }) => knobs[name] === usual) ? DATA.cycles[`${knobs.level} ${knobs.omega1}`] : undefined;
};

function showScene() {
  const scene = DATA.scenes[state.scene], { steps } = scene;
  const rows = steps.map((step, i) => {
    const choice = make("input", { type: "radio", name: "step", checked: i === state.step, onchange: () => enter(state.scene, i) });
    return make("label", {}, choice, make("span", { textContent: step.name }), make("output"));
  });
  const known = scene.predict
    ? [["exact cycle", "exact"], ["describing function", "predicted"]].map(([name, key]) => {
      const number = cycle()?.[key];
      return make("div", { className: "known" }, name, make("b", { textContent: number ? degrees(number) : "no cycle" }));
    }) : [];
  const look = isStep() ? steps[state.step].look : "These are your own settings. Choose a line to come back to the scene.";
  const following = DATA.scenes[state.scene + 1];
  const isLast = state.step === steps.length - 1;
  const onward = !isLast ? "Next step" : following ? `Next: ${following.name}` : "Begin again";
  $("scene").replaceChildren(
    make("h2", { textContent: scene.title }), make("p", { textContent: scene.text }),
    make("p", { className: "look", textContent: look }),
    make("fieldset", { ariaLabel: "Steps of the scene" }, ...rows, ...known),
    make("div", { className: "row" }, make("button", { textContent: "Back", disabled: !state.scene && !state.step, onclick: back }),
      make("button", { textContent: onward, className: "primary", title: "N", onclick: next })),
  );
  tell();
}

function showScenes() {
  $("scenes").replaceChildren(...DATA.scenes.map((scene, i) => {
    const button = make("button", { onclick: () => enter(i, 0), title: scene.title }, make("b"), make("span", { textContent: scene.name }));
    return make("li", {}, button);
  }));
}

function showKnobs() {
  for (const { name, values, base, unit } of DATA.knobs) {
    const control = $(`knob-${name}`), value = loop.knobs[name];
    if (base === undefined) control.value = value;
    else {
      control.value = values.indexOf(value);
      control.style.setProperty("--part", `${(100 * control.value) / (values.length - 1)}%`);
      const shown = `${Number((base * Number(value)).toPrecision(3))} ${unit}`.trim();
      control.ariaValueText = control.parentElement.querySelector("output").textContent = shown;
    }
  }
  DATA.what_if.forEach(({ knobs }, i) => {
    $("chips").children[i].ariaPressed = Object.entries(knobs).every(([name, value]) => loop.knobs[name] === value);
  });
}

function makeKnobs() {
  $("chips").append(...DATA.what_if.map(({ name, knobs }) => make("button", {
    textContent: name,
    onclick: (event) => {
      const isOn = event.target.ariaPressed === "true";
      choose(isOn ? Object.fromEntries(Object.keys(knobs).map((each) => [each, initial[each]])) : knobs);
    },
  })));
  for (const { name, title, symbol, meaning, values, words, base, in_sight: inSight } of DATA.knobs) {
    const control = base === undefined
      ? make("select", { onchange: () => choose({ [name]: control.value }) }, ...values.map((value, i) => new Option(words[i], value)))
      : make("input", { type: "range", min: 0, max: values.length - 1, oninput: () => choose({ [name]: values[control.value] }) });
    control.id = `knob-${name}`;
    const label = make("label", { htmlFor: control.id }, title, " ", symbol, ...(base === undefined ? [] : [make("output")]));
    const knob = make("div", { className: "knob" }, label, control);
    if (!inSight) knob.append(make("small", { textContent: meaning }));
    $(inSight ? "sliders" : "knobs").append(knob);
  }
  showKnobs();
}

// What is told in words and numbers, a few times a second.
function tell() {
  const result = measured(), waits = result === null;
  if (isStep() && !waits) {
    if (results[state.scene][state.step] === null) $("said").textContent = `The arm swings ${said(result)}.`;
    results[state.scene][state.step] = result;
  }
  const fell = result === "fell";
  $("swing").textContent = fell ? "–" : degrees(size());
  $("counts").textContent = waits ? waiting() : fell ? "fell" : counts(size());
  $("was").textContent = state.was && !waits ? `before: ${degrees(state.was)}` : "";
  document.querySelector(".big").classList.toggle("measuring", waits || fell);
  $("fallen").hidden = !hasFallen();
  const here = results[state.scene], largest = Math.max(...here.filter(Number.isFinite), LONG_BAR);
  document.querySelectorAll("fieldset label").forEach((row, i) => {
    const known = here[i] !== null;
    row.classList.toggle("waits", !known);
    row.querySelector("output").textContent = known ? said(here[i]) : i !== state.step ? "not yet" : `${Math.ceil(remaining())} s …`;
    row.style.setProperty("--part", `${here[i] > 0 ? (100 * here[i]) / largest : 0}%`);
  });
  results.forEach((scene, i) => {
    const button = $("scenes").children[i].firstChild, part = scene.filter((each) => each !== null).length / scene.length;
    button.classList.toggle("done", part === 1 && i !== state.scene);
    button.firstChild.textContent = part === 1 ? "✓" : i + 1;
    button.firstChild.style.setProperty("--part", `${100 * part}%`);
    if (i === state.scene) button.ariaCurrent = "step";
    else button.removeAttribute("aria-current");
  });
}

function showNow() {
  const s = loop.signals;
  $("now-phi").textContent = `${text(wrapped(s[0]) / DEGREE, 1)}°`;
  $("now-theta").textContent = `${text(wrapped(s[2]) / DEGREE, 1)}°`;
  $("now-u").textContent = `${text(s[12], 2)} V`;
  $("now-f").textContent = `${text(s[10], 2)} V`;
}

// Drawing. Each frame draws the stage and one chart: charts cost more than they tell.

let stage, frames = 0, late = 0, asked = performance.now(), detail = 0, fixed = false;
const SIMPLER = [[true, 1], [false, 1], [false, 0.75], [false, 0.5]];

// Fewer details where frames come late: first without smooth edges, then with fewer pixels.
function simplify(level, forever = false) {
  fixed = forever;
  const before = SIMPLER[detail], after = SIMPLER[(detail = Math.min(level, SIMPLER.length - 1))];
  if (after[0] !== before[0]) stage.renew(after[0]);
  stage.detail = after[1];
}

function watchTime(now) {
  if (now - asked > 45 && now - asked < 500) late++;
  asked = now;
  if (frames % 30 === 0) {
    if (late > 15 && !fixed) simplify(detail + 1);
    late = 0;
  }
}

const thinned = (rows, most) => rows.filter((_, i) => (rows.length - 1 - i) % Math.max(1, Math.floor(rows.length / most)) === 0);
const curve = (rows, x, y, colour, width) => ({ x: rows.map(x), y: rows.map(y), colour, width });
const column = (i) => (row) => row[i];
// Angles in degrees; whole turns of the arm until the last row do not count.
const angle = (rows, i) => {
  const past = turns(rows.at(-1)?.[i] ?? 0);
  return (row) => (row[i] - past) / DEGREE;
};

const CHARTS = [
  () => {
    const now = loop.time, rows = thinned(newest(SHOWN), 500), curves = [], { before } = state;
    if (before) {
      const end = before.rows.at(-1)?.[TIME] ?? 0, from = before.at - now;
      curves.push(curve(thinned(before.rows.filter((row) => row[TIME] - end > Math.max(-SHOWN, from)), 400), (row) => row[TIME] - end, angle(before.rows, PHI), "was", 1.6));
    }
    const time = (row) => row[TIME] - now;
    curves.push(curve(rows, time, angle(rows, THETA), "pendulum", 1.6), curve(rows, time, angle(rows, PHI), "arm", 2.2));
    chart("angles", curves, { across: [-SHOWN, 0], least: { y: 5 } });
  },
  () => {
    const now = loop.time, rows = thinned(newest(SHOWN), 500), time = (row) => row[TIME] - now;
    chart("voltages", [curve(rows, time, column(U), "command", 1.2), curve(rows, time, column(F), "friction", 2.4), curve(rows, time, column(F_HAT), "estimate", 1.4)], { across: [-SHOWN, 0], least: { y: 0.4 } });
  },
  () => {
    const rows = thinned(newest(PLANE), 400), s = loop.signals;
    const curves = [curve(rows, column(SPEED), column(F), "friction", 2.4), curve(rows, column(SPEED), column(F_HAT), "estimate", 1.4)];
    chart("frictions", curves, { least: { x: 1, y: 0.2 }, dot: { x: s[1], y: s[10], colour: "friction" } });
  },
  () => {
    const rows = thinned(newest(PLANE), 400), s = loop.signals, orbit = cycle()?.orbit ?? [];
    const middle = orbit.length ? (Math.min(...orbit.map(([x]) => x)) + Math.max(...orbit.map(([x]) => x))) / 2 : 0;
    const curves = [curve(orbit, ([x]) => (x - middle) / DEGREE, ([, y]) => y, "was", 6), curve(rows, angle(rows, PHI), column(SPEED), "arm", 1.8)];
    chart("phase", curves, { least: { x: 10, y: 0.5 }, dot: { x: wrapped(s[0]) / DEGREE, y: s[1], colour: "arm" } });
  },
];

// All that is shown, now.
function redraw() {
  draw();
  CHARTS.forEach((draws) => draws());
  showNow();
  tell();
}

function draw() {
  const s = loop.signals, [from, to] = swing();
  stage?.draw({ phi: s[0], theta: s[2], from, to, u: s[12], friction: s[10] });
}

function frame(now) {
  owed += (Math.min(now - last, 100) * state.speed * RATE) / 1000;
  last = now;
  if (state.paused || state.held?.part) owed = 0;
  advance(owed);
  owed %= EVERY;
  if (!state.paused || state.held || frames % 10 === 0) draw();  // a pause costs little
  if (!state.paused || frames % 40 < CHARTS.length) CHARTS[frames % CHARTS.length]();
  if (frames % 6 === 0) showNow();
  if (++frames % 12 === 0) tell();
  watchTime(now);
  requestAnimationFrame(frame);
}

// Pointer: hold the pendulum or the arm, or turn the view.

function at(event) {
  const box = $("stage").getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

$("stage").onpointerdown = (event) => {
  if (event.target.id !== "view") return;
  const part = stage.under(at(event), loop.signals[0], loop.signals[2]);
  if (part) changed();
  state.held = { part, at: at(event) };
  event.target.setPointerCapture(event.pointerId);
  event.target.classList.add("holds");
};
$("stage").onpointermove = (event) => {
  const { held } = state, [x, y] = at(event), s = loop.signals;
  if (!held) return;
  if (held.part) {
    const i = held.part === "arm" ? 0 : 2, turned = stage.ahead(held.part, [x, y], s[0], s[2]);
    s[i] = wrapped(s[i] + Math.max(-0.2, Math.min(0.2, turned)));
  } else {
    stage.view.turn -= (x - held.at[0]) / 200;
    stage.view.height = Math.max(0.08, Math.min(1.3, stage.view.height + (y - held.at[1]) / 200));
  }
  held.at = [x, y];
};
// The pendulum is let go at rest, where the hand has moved it.
$("stage").onpointerup = $("stage").onpointercancel = (event) => {
  const part = state.held?.part;
  state.held = null;
  event.target.classList.remove("holds");
  if (part) {
    reset(wrapped(loop.signals[0]), wrapped(loop.signals[2]));
    setPaused(false);
  }
};

// Buttons and keys

function setPaused(paused) {
  state.paused = paused;
  $("play").innerHTML = paused ? PLAY : PAUSE;
  $("play").ariaLabel = paused ? "Go on" : "Pause";
}

function pushPart(part, direction = (state.side = -state.side)) {
  state.push = null;
  push(part === "arm" ? direction * PUSHES.arm : 0, part === "pendulum" ? direction * PUSHES.pendulum : 0);
}

function setSpeed(name) {
  state.speed = SPEEDS[name];
  for (const button of $("speed").children) button.ariaPressed = String(button.textContent === name);
}

function toast(words) {
  $("toast").textContent = words;
  $("toast").hidden = false;
  clearTimeout(toast.timer);
  toast.timer = setTimeout(() => { $("toast").hidden = true; }, 5000);
}

// The settings as the end of a link, and back.
function link() {
  const own = Object.entries(loop.knobs).filter(([name, value]) => value !== initial[name]);
  const place = { scene: state.scene + 1, ...(isStep() ? { step: state.step + 1 } : Object.fromEntries(own)) };
  return `#${new URLSearchParams(place)}`;
}

function share() {
  location.replace(link());
  const done = (words) => toast(`${words} It holds the scene and all settings.`);
  const failed = () => done("The link is in the address bar.");
  (navigator.clipboard?.writeText(location.href) ?? Promise.reject()).then(() => done("The link is copied."), failed);
}

function follow() {
  const { scene = "1", step, ...knobs } = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
  const own = Object.entries(knobs), place = [scene - 1, (step ?? 1) - 1];
  const wrong = own.find(([name, value]) => !knobOf[name]?.values.includes(value))?.join("=");
  if (wrong || !DATA.scenes[place[0]]?.steps[place[1]]) {
    toast(`The link asks for ${wrong ?? `step ${step ?? 1} of scene ${scene}`}, which this page does not have.`);
    enter(0, 0);
    return;
  }
  enter(...place);
  if (own.length) choose({ ...initial, ...knobs });
}

const KEYS = {
  " ": () => setPaused(!state.paused), r: () => reset(), n: next, b: back, p: () => pushPart("pendulum"),
  ArrowLeft: () => pushPart("arm", -1), ArrowRight: () => pushPart("arm", 1),
  ...Object.fromEntries(DATA.scenes.map((_, i) => [String(i + 1), () => enter(i, 0)])),
};
document.onkeydown = (event) => {
  const own = { BUTTON: [" "], SUMMARY: [" "], INPUT: [" ", "ArrowLeft", "ArrowRight"], SELECT: Object.keys(KEYS) };
  if (event.ctrlKey || event.metaKey || event.altKey || !KEYS[event.key] || own[event.target.tagName]?.includes(event.key)) return;
  KEYS[event.key]();
  event.preventDefault();
};
$("play").onclick = () => setPaused(!state.paused);
$("reset").onclick = $("again").onclick = () => reset();
$("share").onclick = share;
$("picture").onclick = () => { draw(); pictureFile($("stage").firstChild); };
$("numbers").onclick = () => numbersFile(newest(SHOWN));
for (const button of document.querySelectorAll("[data-push]")) button.onclick = () => pushPart(button.dataset.push);
$("speed").append(...Object.keys(SPEEDS).map((name) => make("button", { textContent: name, onclick: () => setSpeed(name) })));

try {
  stage = new Stage($("stage"), true);
  const gl = stage.renderer.getContext(), about = gl.getExtension("WEBGL_debug_renderer_info");
  if (about && /swiftshader|llvmpipe|software/i.test(gl.getParameter(about.UNMASKED_RENDERER_WEBGL))) simplify(1);
} catch {
  toast("This browser cannot draw in 3D (WebGL); the charts work.");
}
matchMedia("(prefers-color-scheme: dark)").onchange = () => { forgetColours(); stage?.paint(); };
addEventListener("hashchange", follow);
$("more").open = innerHeight > 900;
showScenes();
makeKnobs();
setSpeed("1×");
setPaused(matchMedia("(prefers-reduced-motion: reduce)").matches);
if (state.paused) toast("Motion is paused, because your system asks for less of it. Press play.");
follow();
// For tests and the curious: open the console.
window.page = { DATA, Loop, loop, state, results, advance, tell, draw, redraw, enter, choose, reset, size, simplify, cycle, history: () => history, frames: () => frames, detail: () => detail, stage: () => stage };
requestAnimationFrame(frame);
