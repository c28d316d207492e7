// The page: scenes, controls, buttons and keys around the motion and its drawing.
import { forgetColours, text } from "./charts.js";
import { DEGREE, Drawing } from "./drawing.js";
import { numbersFile, pictureFile } from "./files.js";
import { Loop, RATE, unpacked } from "./loop.js";
import { Motion, wrapped } from "./motion.js";
import { Pointer } from "./pointer.js";

const DATA = await unpacked(document.getElementById("data").textContent);
const PUSHES = { arm: 2, pendulum: 0.3 };  // for 0.1 s [V]
const LONG_BAR = 5 * DEGREE;  // a swing whose bar may fill its line
const SPEEDS = { "¼": 0.25, "½": 0.5, "1×": 1, "2×": 2 };
const PAUSE = '<svg viewBox="0 0 16 16"><rect x="3" y="2" width="4" height="12" rx="1"/><rect x="9" y="2" width="4" height="12" rx="1"/></svg>';
const PLAY = '<svg viewBox="0 0 16 16"><path d="M4 2v12l10-6z"/></svg>';

const $ = (id) => document.getElementById(id);
const make = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};
const motion = new Motion(DATA), { loop } = motion;
const knobOf = Object.fromEntries(DATA.knobs.map((knob) => [knob.name, knob]));
const initial = Object.fromEntries(DATA.knobs.map((knob) => [knob.name, knob.initial]));
// The result of each step, and settings of the user's own with their result.
const results = DATA.scenes.map((scene) => scene.steps.map(() => null));
const own = { name: "your settings", knobs: null, result: null };
// A scene, the step that it is at, whether the user's own settings run instead, and whether the user has pushed.
const state = { scene: 0, step: 0, isOwn: false, pushed: false, paused: false, speed: 1, side: 1 };
const drawing = new Drawing($("stage"), motion, cycle);
let pointer, last = performance.now();

function degrees(radians) {
  const value = radians / DEGREE;
  return `${text(value, value < 3 ? 2 : 1)}°`;
}

function counts(radians) {
  const n = (radians * DATA.encoder_counts) / (2 * Math.PI);
  if (n < 0.95) return "less than one encoder count";
  return n < 1.05 ? "one encoder count" : `${n.toFixed(n < 9.5 ? 1 : 0)} encoder counts`;
}

// Knobs and scenes

function setKnobs(knobs) {
  motion.turn(knobs);
  showKnobs();
}

// The user's own settings.
function choose(knobs) {
  Object.assign(state, { isOwn: true, pushed: false });
  motion.planned = null;
  setKnobs(knobs);
  Object.assign(own, { knobs: { ...loop.knobs }, result: null });
  motion.name = own.name;
  showScene();
}

function enter(scene, step) {
  const { name, knobs, push } = DATA.scenes[scene].steps[step];
  Object.assign(state, { scene, step, isOwn: false, pushed: false });
  setKnobs({ ...initial, ...knobs });
  motion.name = name;
  motion.planned = push ? [push["pushes.arm"] || 0, push["pushes.pendulum"] || 0] : null;
  showScene();
}

function next() {
  const step = state.step + 1;
  enter(...(step < DATA.scenes[state.scene].steps.length ? [state.scene, step] : [(state.scene + 1) % DATA.scenes.length, 0]));
}

function back() {
  const { scene, step } = state;
  if (step) enter(scene, step - 1);
  else if (scene) enter(scene - 1, DATA.scenes[scene - 1].steps.length - 1);
}

function said(result) {
  return result === "fell" ? result : degrees(result);
}

function waiting() {
  if (motion.planned) return `push in ${Math.ceil(motion.untilPush)} s`;
  if (motion.swingsUp && motion.leans) return "swinging up";
  return `measuring: ${Math.ceil(motion.remaining)} s`;
}

// The exact cycle of these settings without compensation; null: there is none, undefined: it is not known.
function cycle() {
  const { knobs } = loop;
  const others = DATA.knobs.filter(({ name }) => !["level", "omega1", "compensation", "believed", "strength", "sensors"].includes(name));
  return others.every(({ name, initial: usual }) => knobs[name] === usual) ? DATA.cycles[`${knobs.level} ${knobs.omega1}`] ?? null : undefined;
}

function showScene() {
  const scene = DATA.scenes[state.scene], { steps } = scene;
  const row = (name, checked, onchange) => {
    const choice = make("input", { type: "radio", name: "step", checked, onchange });
    return make("label", {}, choice, make("span", { textContent: name }), make("output"));
  };
  const rows = steps.map(({ name }, i) => row(name, !state.isOwn && i === state.step, () => enter(state.scene, i)));
  if (own.knobs) rows.push(row(own.name, state.isOwn, () => choose(own.knobs)));
  const known = scene.predict
    ? [["exact cycle", "exact"], ["describing function", "predicted"]].map(([name, key]) => {
      const found = cycle(), number = found ? degrees(found[key]) : found === null ? "no cycle" : "not for these settings";
      return make("div", { className: "known" }, name, make("b", { textContent: number }));
    }) : [];
  const look = state.isOwn ? "These are your own settings. Choose another line to come back to the scene." : steps[state.step].look;
  const following = DATA.scenes[state.scene + 1];
  const isLast = state.step === steps.length - 1;
  const onward = !isLast ? "Next step" : following ? `Next: ${following.name}` : "Begin again";
  const controls = () => [...$("scene").querySelectorAll("input, button")];
  const old = controls(), place = old.indexOf(document.activeElement);
  $("scene").replaceChildren(
    make("h2", { textContent: scene.title }), make("p", { textContent: scene.text }),
    make("p", { className: "look", textContent: look }),
    make("fieldset", { ariaLabel: "Steps of the scene" }, ...rows, ...known),
    make("div", { className: "row" }, make("button", { textContent: "Back", disabled: !state.scene && !state.step, onclick: back }),
      make("button", { textContent: onward, className: "primary", title: "N", onclick: next })),
  );
  // The keyboard stays where it was: at a line, or at one of the two buttons at the end.
  if (place >= 0) controls().at(place < old.length - 2 ? place : place - old.length).focus();
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
      const shown = `${Number((base * Number(value)).toFixed(2))} ${unit}`.trim();
      control.ariaValueText = control.parentElement.querySelector("output").textContent = shown;
    }
  }
  $("knob-believed").disabled = loop.knobs.compensation === "none";  // nothing expects any friction
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
  for (const [word, meaning] of Object.entries(DATA.words)) $("words").append(make("dt", { textContent: word }), make("dd", { textContent: meaning }));
  showKnobs();
}

// Keeps what has been measured. A fall that the user has caused says nothing of the step.
function keep(result) {
  if (result === null || (result === "fell" && state.pushed)) return;
  if (state.isOwn) own.result = result;
  else {
    if (results[state.scene][state.step] === null) $("said").textContent = `${motion.name}: ${said(result)}`;
    results[state.scene][state.step] = result;
  }
}

// What is told in words and numbers, a few times a second.
function tell() {
  const { result, size, was } = motion, waits = result === null, fell = result === "fell";
  keep(result);
  $("swing").textContent = fell ? "–" : degrees(size);
  $("counts").textContent = waits ? waiting() : fell ? "fell" : counts(size);
  $("was").textContent = was && !waits ? `${was.name}: ${degrees(was.size)}` : "";
  document.querySelector(".big").classList.toggle("measuring", waits || fell);
  $("fallen").hidden = !motion.hasFallen;
  const here = [...results[state.scene], own.result], runs = state.isOwn ? here.length - 1 : state.step;
  const largest = Math.max(...here.filter(Number.isFinite), LONG_BAR);
  document.querySelectorAll("fieldset label").forEach((row, i) => {
    const isNow = i === runs && waits, known = here[i] !== null && !isNow;
    row.classList.toggle("waits", !known);
    row.querySelector("output").textContent = known ? said(here[i]) : isNow ? waiting().replace("measuring: ", "") : "not yet";
    row.style.setProperty("--part", `${here[i] > 0 ? (100 * here[i]) / largest : 0}%`);
  });
  showProgress();
}

function showProgress() {
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

function frame(now) {
  const passed = Math.min(now - last, 100), isStill = state.paused && !pointer?.held;
  last = now;
  if (!state.paused && !pointer?.held?.part) motion.advance((passed * state.speed * RATE) / 1000);
  drawing.frame(now, isStill);
  if (drawing.frames % 6 === 0) showNow();
  if (drawing.frames % 12 === 0) tell();
  requestAnimationFrame(frame);
}

// Buttons and keys

function setPaused(paused) {
  state.paused = paused;
  $("play").innerHTML = paused ? PLAY : PAUSE;
  $("play").ariaLabel = paused ? "Go on" : "Pause";
}

function pushPart(part, direction = (state.side = -state.side)) {
  state.pushed = true;
  motion.push(part === "arm" ? direction * PUSHES.arm : 0, part === "pendulum" ? direction * PUSHES.pendulum : 0);
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
  const turned = Object.entries(loop.knobs).filter(([name, value]) => value !== initial[name]);
  const place = { scene: state.scene + 1, ...(state.isOwn ? Object.fromEntries(turned) : { step: state.step + 1 }) };
  return `#${new URLSearchParams(place)}`;
}

function share() {
  window.history.replaceState(null, "", link());
  const done = (words) => toast(`${words} It holds the scene and the settings.`);
  const failed = () => done("The link is in the address bar.");
  (navigator.clipboard?.writeText(location.href) ?? Promise.reject()).then(() => done("The link is copied."), failed);
}

function follow() {
  const { scene = "1", step, ...knobs } = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
  const given = Object.entries(knobs), place = [scene - 1, (step ?? 1) - 1];
  const wrong = given.find(([name, value]) => !knobOf[name]?.values.includes(value))?.join("=");
  if (wrong || !DATA.scenes[place[0]]?.steps[place[1]]) {
    toast(`The link asks for ${wrong ?? `step ${step ?? 1} of scene ${scene}`}, which this page does not have.`);
    enter(0, 0);
    return;
  }
  enter(...place);
  if (given.length) choose({ ...initial, ...knobs });
}

const KEYS = {
  " ": () => setPaused(!state.paused), r: () => motion.reset(), n: next, b: back, p: () => pushPart("pendulum"),
  ArrowLeft: () => pushPart("arm", -1), ArrowRight: () => pushPart("arm", 1),
  ...Object.fromEntries(DATA.scenes.map((_, i) => [String(i + 1), () => enter(i, 0)])),
};
document.onkeydown = (event) => {
  const native = { BUTTON: [" "], SUMMARY: [" "], INPUT: [" ", "ArrowLeft", "ArrowRight"], SELECT: Object.keys(KEYS) };
  if (event.ctrlKey || event.metaKey || event.altKey || !KEYS[event.key] || native[event.target.tagName]?.includes(event.key)) return;
  KEYS[event.key]();
  event.preventDefault();
};
$("play").onclick = () => setPaused(!state.paused);
$("reset").onclick = $("again").onclick = () => motion.reset();
$("share").onclick = share;
$("picture").onclick = () => { drawing.drawAll(); pictureFile(`${DATA.scenes[state.scene].title}: ${motion.name}, ${link().slice(1)}`); };
$("numbers").onclick = () => numbersFile(motion.newest());
for (const button of document.querySelectorAll("[data-push]")) button.onclick = () => pushPart(button.dataset.push);
$("speed").append(...Object.keys(SPEEDS).map((name) => make("button", { textContent: name, onclick: () => setSpeed(name) })));

if (drawing.stage) {
  pointer = new Pointer($("stage"), drawing.stage, loop.signals, () => { state.pushed = true; motion.changed(); }, (phi, theta) => {
    motion.reset(phi, theta);
    setPaused(false);
  });
}
matchMedia("(prefers-color-scheme: dark)").onchange = () => { forgetColours(); drawing.stage?.paint(); };
addEventListener("hashchange", follow);
$("more").open = innerHeight > 900;
showScenes();
makeKnobs();
setSpeed("1×");
setPaused(matchMedia("(prefers-reduced-motion: reduce)").matches);
if (!drawing.stage) toast("This browser cannot draw in 3D (WebGL). All else works.");
else if (state.paused) toast("Motion is paused, because your system asks for less of it. Press play.");
follow();
// For tests and the curious: open the console.
window.page = { DATA, Loop, motion, drawing, state, results, tell, enter, choose, cycle };
requestAnimationFrame(frame);
