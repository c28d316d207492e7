// The page: scenes, controls, buttons and keys around the motion and its drawing.
import { forgetColours, text } from "./charts.js";
import { Controls, make } from "./controls.js";
import { DEGREE, Drawing } from "./drawing.js";
import { numbersFile, pictureFile } from "./files.js";
import { Graph } from "./graph.js";
import { Loop, RATE, unpacked } from "./loop.js";
import { Motion } from "./motion.js";
import { Pointer } from "./pointer.js";
import { F, PHI, THETA, TIME, U, wrapped } from "./source.js";

const DATA = await unpacked(document.getElementById("data").textContent);
const PUSHES = { arm: 2, pendulum: 0.3 };  // for 0.1 s [V], as the user has set them
const PUSH_RANGE = { min: 0.1, max: 5, step: 0.1 };
const NO_WEBGL = "This browser cannot draw in 3D (WebGL). All else works.";
const OWN_LOOK = "These are your own settings. Choose another line to come back to the scene.";
const SLOW = 0.9;  // share of the wanted speed below which the page says so
const LONG_BAR = 5 * DEGREE;  // a swing whose bar may fill its line
const PAUSE = '<svg viewBox="0 0 16 16"><path d="M3 2h4v12H3zM9 2h4v12H9z"/></svg>';
const PLAY = '<svg viewBox="0 0 16 16"><path d="M4 2v12l10-6z"/></svg>';

const $ = (id) => document.getElementById(id);
const source = DATA.wasm ? new Loop(DATA) : new Graph(DATA);
const motion = new Motion(DATA, source);
const controls = new Controls(source, choose);
// The result of each step, and settings of the user's own with their result.
const results = DATA.scenes.map((scene) => scene.steps.map(() => null));
const own = { name: "your settings", knobs: null, result: null };
// A scene, the step that it is at, whether the user's own settings run instead, and whether the user has pushed.
const state = { scene: 0, step: 0, isOwn: false, pushed: false, paused: false, speed: 1 };
const drawing = new Drawing($("stage"), motion);
// Wall time and time of the source when its speed was measured last, and that speed.
const pace = { wall: 0, time: NaN, factor: NaN };
let pointer, last = performance.now();

function degrees(radians) {
  const value = radians / DEGREE;
  return `${text(value, value < 3 ? 2 : 1)}°`;
}

function counts(radians) {
  const n = (radians * source.encoderCounts) / (2 * Math.PI);
  if (!n) return "";
  if (n < 0.95) return "less than one encoder count";
  return n < 1.05 ? "one encoder count" : `${n.toFixed(n < 9.5 ? 1 : 0)} encoder counts`;
}

// Knobs and scenes

const here = () => ({ scene: state.scene, step: state.step, isOwn: state.isOwn });

// The user's own settings.
function choose(values) {
  Object.assign(state, { isOwn: true, pushed: false });
  motion.planned = null;
  Object.assign(own, { knobs: source.own(values), result: null });
  motion.turn(values, here());
  motion.name = own.name;
  show();
}

function enter(scene, step) {
  const { name, push } = DATA.scenes[scene].steps[step];
  if (!source.hasScenes) return;
  if (state.isOwn && state.speed === null) setSpeed(1);  // faster than the eye
  Object.assign(state, { scene, step, isOwn: false, pushed: false });
  motion.turn({ ...source.scenesBase, ...source.change(DATA.scenes[scene].steps[step]) }, here());
  motion.name = name;
  motion.planned = push ? [push["pushes.arm"] || 0, push["pushes.pendulum"] || 0] : null;
  show();
}

function show() {
  showKnobs();
  showScene();
}

// Whether nothing differs from what a step sets.
function isStepInForce(scene, step) {
  const wanted = { ...source.scenesBase, ...source.change(DATA.scenes[scene].steps[step]) };
  return source.hasScenes && Object.entries(wanted).every(([name, value]) => source.values[name] === value);
}

function next() {
  const step = state.step + 1;
  const isLast = step === DATA.scenes[state.scene].steps.length;
  enter(...(isLast ? [(state.scene + 1) % DATA.scenes.length, 0] : [state.scene, step]));
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
  if (source.swingsUp && motion.leans) return "swinging up";
  return `measuring: ${Math.ceil(motion.remaining)} s`;
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
      const { cycle } = source, words = { undefined: "not for these settings", null: "no cycle", computing: "computing …" };
      return make("div", { className: "known" }, name, make("b", { textContent: words[cycle] ?? degrees(cycle[key]) }));
    }) : [];
  const look = state.isOwn ? OWN_LOOK : steps[state.step].look;
  const following = DATA.scenes[state.scene + 1];
  const isLast = state.step === steps.length - 1;
  const onward = !isLast ? "Next step" : following ? `Next: ${following.name}` : "Begin again";
  const inputs = () => [...$("scene").querySelectorAll("input, button")];
  const old = inputs(), place = old.indexOf(document.activeElement);
  $("scene").replaceChildren(
    make("h2", { textContent: scene.title }), make("p", { className: "scene-text", textContent: scene.text }),
    make("p", { className: "look", textContent: look }),
    make("fieldset", { ariaLabel: "Steps of the scene" }, ...rows, ...known),
    make("div", { className: "row" }, make("button", { textContent: "Back", disabled: !state.scene && !state.step, onclick: back }),
      make("button", { textContent: onward, className: "primary", title: "N", onclick: next })),
  );
  // The keyboard stays where it was: at a line, or at one of the two buttons at the end.
  if (place >= 0) inputs().at(place < old.length - 2 ? place : place - old.length).focus();
  showNamed(steps[state.step].chart);
  tell();
}

// On a narrow page the chart that the step names stands below the stage.
function showNamed(chart) {
  for (const figure of document.querySelectorAll("figure")) figure.classList.toggle("named", figure.querySelector("canvas").id === chart);
}

function showScenes() {
  $("scenes").replaceChildren(...DATA.scenes.map((scene, i) => {
    const button = make("button", { onclick: () => enter(i, 0), title: scene.title }, make("b"), make("span", { textContent: scene.name }));
    return make("li", {}, button);
  }));
}

function showKnobs() {
  controls.show();
  DATA.what_if.forEach((told, i) => {
    $("chips").children[i].ariaPressed = Object.entries(source.change(told)).every(([name, value]) => source.values[name] === value);
  });
}

function makeKnobs() {
  $("chips").replaceChildren(...DATA.what_if.map((told) => make("button", {
    textContent: told.name,
    onclick: (event) => {
      const isOn = event.target.ariaPressed === "true", change = source.change(told);
      choose(isOn ? Object.fromEntries(Object.keys(change).map((each) => [each, source.base[each]])) : change);
    },
  })));
  controls.build();
  showKnobs();
}

function showWords() {
  for (const [word, meaning] of Object.entries(DATA.words)) {
    $("words").append(make("dt", { textContent: word }), make("dd", { textContent: meaning }));
  }
}

// Keeps what has been measured, and says it when it is new. A fall that the user has caused says nothing of the step.
function keep(result) {
  if (result === null || (result === "fell" && state.pushed)) return;
  const known = state.isOwn ? own.result : results[state.scene][state.step];
  if (state.isOwn) own.result = result;
  else results[state.scene][state.step] = result;
  if (known !== null && state.said) return;
  state.said = true;
  const { name, was } = motion, before = was ? `; before, ${was.name}: ${degrees(was.size)}` : "";
  const size = result === "fell" ? "the pendulum fell" : `the arm swings ${degrees(result)}, ${counts(result)}`;
  $("said").textContent = `${name}: ${size}${before}`;
}

// What is told in words and numbers, a few times a second.
function tell() {
  const { result, size, was } = motion, waits = result === null, fell = result === "fell";
  keep(result);
  $("swing").textContent = fell ? "–" : degrees(size);
  $("counts").textContent = isStarting() ? "starting" : waits ? waiting() : fell ? "fell" : counts(size);
  $("figures").textContent = waits || fell ? "" : figures();
  $("was").textContent = was && !waits ? `${was.name}: ${degrees(was.size)}` : "";
  document.querySelector(".big").classList.toggle("measuring", waits || fell);
  $("fallen").hidden = !motion.hasFallen || motion.moment;
  showPast();
  const here = [...results[state.scene], own.result], runs = state.isOwn ? here.length - 1 : state.step;
  const largest = Math.max(...here.filter(Number.isFinite), LONG_BAR);
  document.querySelectorAll("fieldset label").forEach((row, i) => {
    const isNow = i === runs && waits, known = here[i] !== null && !isNow;
    row.classList.toggle("waits", !known);
    row.querySelector("output").textContent = known ? said(here[i]) : isNow ? waiting().replace("measuring: ", "") : "not yet";
    row.style.setProperty("--part", `${here[i] > 0 ? (100 * here[i]) / largest : 0}%`);
  });
  if (waits) state.said = false;
  showProgress();
  showTime();
}

const isStarting = () => Number.isNaN(source.time) || (!motion.rows.length && !state.paused);

// What else is known of the motion that is measured.
function figures() {
  const [from, to] = motion.swing(THETA), { period } = motion;
  return `${source.encoderCounts ? ", " : ""}pendulum ${degrees(to - from)}${Number.isNaN(period) ? "" : `, period ${text(period, 2)} s`}`;
}

// The time of the source, how fast it passes, and what its status says.
function showTime() {
  const { title = "", late, lost, waiting: waits } = source.status, { time, zero } = source, now = performance.now();
  const wall = (now - pace.wall) / 1000, passed = time - pace.time;
  if (wall > 2 || !(passed >= 0)) {
    pace.factor = passed >= 0 && wall < 4 ? passed / wall : NaN;
    Object.assign(pace, { wall: now, time });
  }
  const { factor } = pace, wanted = state.speed ?? 0, words = [title];
  if (!Number.isNaN(time)) words.push(`t = ${text(time - zero, 1)} s`);
  const tellsSpeed = !state.paused && factor > 0 && (!source.isHere || factor < SLOW * wanted);
  if (tellsSpeed) words.push(`${text(factor, factor < 9.95 ? 1 : 0)} × real time`);
  if (late) words.push(`late samples ${late}`);
  document.querySelector(".hint").textContent = lost || waits ? "" : words.filter(Boolean).join(" · ");
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
  const { now } = motion, shown = (value, digits, unit) => (Number.isNaN(value) ? "–" : `${text(value, digits)}${unit}`);
  $("now-phi").textContent = shown(wrapped(now[PHI]) / DEGREE, 1, "°");
  $("now-theta").textContent = shown(now[THETA] / DEGREE, 1, "°");
  $("now-u").textContent = shown(now[U], 2, " V");
  $("now-f").textContent = shown(now[F], 2, " V");
  $("key-f").hidden = Number.isNaN(now[F]);  // on a rig
}

// While an earlier moment is shown: which, and the way back.
function showPast() {
  const { moment, time } = motion;
  $("past").hidden = !moment;
  if (moment) $("past").firstChild.textContent = `${text(time - moment[TIME], 2)} s ago`;
}

function toPresent() {
  motion.look();
  drawing.drawAll();
  showNow();
  tell();
}

function frame(now) {
  const passed = Math.min(now - last, 100), isHeld = Boolean(motion.held);
  last = now;
  if (!isHeld && !(state.paused && source.isHere)) motion.advance((passed * RATE) / 1000);
  drawing.frame(now, (state.paused || motion.moment) && !pointer?.held);
  if (drawing.frames % 6 === 0) showNow();
  if (drawing.frames % 12 === 0) tell();
  requestAnimationFrame(frame);
}

// Buttons and keys

function setPaused(paused) {
  motion.look();
  if (!source.speeds.length) return;
  state.paused = paused;
  source.pace(paused ? 0 : state.speed);
  showPace();
}

function setSpeed(speed) {
  Object.assign(state, { speed, paused: false });
  source.pace(speed);
  showPace();
}

// From an earlier moment it goes on.
function play() {
  if (motion.moment) toPresent();
  else setPaused(!state.paused);
}

// One step, and then a pause.
function step() {
  motion.look();
  if (!source.speeds.length) return;
  if (!source.isHere) state.paused = true;
  else setPaused(true);
  source.step();
  if (source.isHere) motion.advance(0);
  drawing.drawAll();
  showNow();
  showPace();
}

function showPace() {
  const { speeds } = source, words = speeds.map(([word]) => word);
  if ([...$("speed").options].map(({ text: word }) => word).join() !== words.join()) {
    $("speed").replaceChildren(...words.map((word) => new Option(word)));
  }
  $("speed").selectedIndex = speeds.findIndex(([, speed]) => speed === state.speed);
  $("play").hidden = $("step").hidden = $("speed").hidden = !speeds.length;
  document.querySelector(".bar").hidden = !speeds.length && !source.hasPlant;
  const [shape, label] = state.paused ? [PLAY, "Go on"] : [PAUSE, "Pause"];
  if ($("play").ariaLabel !== label) Object.assign($("play"), { innerHTML: shape, ariaLabel: label });
}

function pushPart(part, side) {
  if (!source.hasPlant) return;
  state.pushed = true;
  const of = (other) => (part === other ? side * PUSHES[other] : 0);
  motion.push(of("arm"), of("pendulum"));
}

// Sliders for the size of a push.
function showPushes() {
  for (const [part, title] of [["arm", "On the arm, for 0.1 s"], ["pendulum", "On the pendulum, for 0.1 s"]]) {
    const output = make("output"), id = `push-${part}`;
    const input = make("input", { type: "range", id, ...PUSH_RANGE, value: PUSHES[part] });
    const label = make("label", { htmlFor: id }, title, output);
    const tellSize = () => {
      PUSHES[part] = Number(input.value);
      input.ariaValueText = output.textContent = `${input.value} V`;
      input.style.setProperty("--part", `${(100 * (input.value - input.min)) / (input.max - input.min)}%`);
    };
    input.oninput = tellSize;
    tellSize();
    $("pushes").append(make("div", { className: "knob" }, label, input));
  }
}

// A chart over the whole page, and back.
function enlarge(figure) {
  const isLarge = figure?.classList.contains("large");
  for (const each of document.querySelectorAll("figure")) each.classList.remove("large");
  if (figure && !isLarge) figure.classList.add("large");
  for (const each of document.querySelectorAll(".enlarge")) {
    const large = each.parentElement.classList.contains("large");
    Object.assign(each, { textContent: large ? "✕" : "⤢", title: large ? "Close (Esc)" : "Enlarge", ariaExpanded: String(large) });
  }
  drawing.drawAll();
}

function addEnlarge() {
  for (const figure of document.querySelectorAll("figure")) {
    const canvas = figure.querySelector("canvas"), ariaLabel = `Enlarge: ${canvas.ariaLabel}`;
    figure.append(make("button", { className: "enlarge", ariaLabel, onclick: () => enlarge(figure) }));
    canvas.ondblclick = () => enlarge(figure);
  }
  enlarge(null);
}

function toast(words) {
  $("toast").textContent = words;
  $("toast").hidden = false;
  clearTimeout(toast.timer);
  toast.timer = setTimeout(() => { $("toast").hidden = true; }, 5000);
}

// The settings as the end of a link, and back.
function link() {
  const turned = Object.entries(source.values).filter(([name, value]) => value !== source.base[name]);
  const place = { scene: state.scene + 1, ...(state.isOwn ? Object.fromEntries(turned) : { step: state.step + 1 }) };
  return `#${new URLSearchParams(place)}`;
}

// What the saved picture shows: the step, or the settings that differ.
function caption() {
  if (!state.isOwn) return `${DATA.scenes[state.scene].title}: ${motion.name}`;
  const { values, base, knobs } = source;
  const changed = knobs.filter(({ name }) => name in base && String(values[name]) !== String(base[name]));
  const word = ({ name, values: all, words }) => words?.[all?.indexOf(values[name])] ?? values[name];
  const words = changed.map((knob) => `${knob.title} ${word(knob)}`);
  return `${own.name}: ${words.slice(0, 4).join(", ") || "as at the start"}`;
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
  const wrong = given.find(([name, value]) => !source.knobs.find((knob) => knob.name === name)?.values.includes(value))?.join("=");
  if (wrong || !DATA.scenes[place[0]]?.steps[place[1]]) {
    toast(`The link asks for ${wrong ?? `step ${step ?? 1} of scene ${scene}`}, which this page does not have.`);
    enter(0, 0);
    return;
  }
  enter(...place);
  if (given.length) choose({ ...source.base, ...knobs });
}

// What the graph has told: of the page, only what differs from a page without one.
function told({ nodes, values, place, status, cycle, failed, refused, began, since }) {
  if (since !== undefined) motion.since = since;
  if (began) motion.begin(began[0], motion.rows.filter(([time]) => time >= began[0]));
  if (nodes) {
    own.knobs ??= source.hasScenes && !isStepInForce(0, 0) ? source.own({}) : null;
    if (state.isOwn && !own.knobs) place ??= null;  // nodes come one by one
    makeKnobs();
    showWhatFits();
    show();
  }
  if (values) {
    if (!nodes) motion.changed();
    showKnobs();
    if (refused) controls.refuse(refused, failed);
  }
  if (place !== undefined) {
    Object.assign(state, place ?? { isOwn: !isStepInForce(0, 0) });
    motion.name = state.isOwn ? own.name : DATA.scenes[state.scene].steps[state.step].name;
    showScene();
  }
  if (cycle !== undefined && !place) showScene();
  if (status) showStatus(status);
  if (failed && !refused) toast(failed);
}

// Scenes need all nodes of the simulated loop; pushes and reset need its plant.
function showWhatFits() {
  const { hasPlant, hasScenes } = source;
  for (const part of document.querySelectorAll("#scene, #scenes, #chips, #settings h2.small")) part.hidden = !hasScenes;
  for (const part of document.querySelectorAll("#reset, .push, #pushes, #with-f")) part.hidden = !hasPlant;
}

function showStatus({ lost, speed, notices = [], rig, waiting: waits }) {
  if (speed !== undefined) Object.assign(state, speed === 0 ? { paused: true } : { paused: false, speed });
  showPace();
  $("waiting").hidden = !waits;
  for (const part of document.querySelectorAll("main, .tools")) part.hidden = Boolean(waits);
  if (waits) [$("place").textContent, $("command").textContent] = [waits.place, waits.command];
  $("rig").hidden = !rig;
  if (rig) {
    Object.assign($("rig-title"), { textContent: rig.title, className: rig.kind });
    $("rig-text").textContent = rig.text;
    $("arm").disabled = rig.kind === "armed";
  }
  const words = lost ? ["The page has lost its server: what it shows is old. It connects again by itself."] : notices;
  $("notice").hidden = !words.length;
  $("notice").textContent = words.join("; ");
  showTime();
}

const KEYS = {
  " ": play, ".": step, r: () => source.hasPlant && motion.reset(), n: next, b: back,
  p: () => pushPart("pendulum", 1), P: () => pushPart("pendulum", -1),
  "+": () => drawing.stage?.zoom(0.9), "-": () => drawing.stage?.zoom(1.1), Escape: () => (motion.moment ? toPresent() : enlarge(null)),
  ArrowLeft: () => pushPart("arm", -1), ArrowRight: () => pushPart("arm", 1),
  ...Object.fromEntries(DATA.scenes.map((_, i) => [String(i + 1), () => enter(i, 0)])),
};
document.onkeydown = (event) => {
  const native = { BUTTON: [" "], SUMMARY: [" "], INPUT: [" ", "ArrowLeft", "ArrowRight"], SELECT: Object.keys(KEYS) };
  const isTyped = event.target.matches("input[type=text], input[type=search]") && event.key !== "Escape";
  const isNative = native[event.target.tagName]?.includes(event.key) || event.ctrlKey || event.metaKey || event.altKey;
  if (isTyped || isNative || !KEYS[event.key]) return;
  KEYS[event.key]();
  event.preventDefault();
};
$("play").onclick = play;
$("present").onclick = toPresent;
drawing.looked = () => {
  showNow();
  tell();
};
$("step").onclick = step;
$("speed").onchange = () => setSpeed(source.speeds[$("speed").selectedIndex][1]);
$("reset").onclick = $("again").onclick = () => motion.reset();
$("share").onclick = share;
$("picture").onclick = () => { drawing.drawAll(); pictureFile(caption()); };
$("numbers").onclick = () => numbersFile(motion.newest());
for (const button of document.querySelectorAll("[data-push]")) {
  button.onclick = () => pushPart(button.dataset.push, Number(button.dataset.side));
}
$("arm").onclick = () => source.send({ arm: true });
$("disarm").onclick = () => source.send({ arm: false });

if (drawing.stage) {
  pointer = new Pointer($("stage"), drawing.stage, motion, () => { state.pushed = true; motion.changed(); }, (phi, theta) => {
    motion.reset(phi, theta);
    setPaused(false);
  });
}
const isDark = matchMedia("(prefers-color-scheme: dark)");

// The names of the quantities; that of the estimate is left out where there is little room.
function nameQuantities() {
  for (const place of document.querySelectorAll("[data-name]")) {
    const { name, symbol } = DATA.quantities[place.dataset.name];
    place.append(place.dataset.name === "estimate" ? make("i", {}, `${name} `) : `${name} `, symbol);
  }
}

// The colours of the quantities, as everywhere in the project.
function paint() {
  for (const [name, look] of Object.entries(DATA.quantities)) {
    document.documentElement.style.setProperty(`--${name}`, isDark.matches ? look.dark : look.light);
  }
  forgetColours();
  drawing.stage?.paint();
}

document.body.classList.toggle("present", new URLSearchParams(location.search).has("present"));
isDark.onchange = paint;
paint();
nameQuantities();
addEventListener("hashchange", () => source.isHere && follow());
$("more").open = innerWidth > 1150 && innerHeight > 900;
showScenes();
showWords();
showPushes();
addEnlarge();
if (source.isHere) {
  makeKnobs();
  setSpeed(1);
  setPaused(matchMedia("(prefers-reduced-motion: reduce)").matches);
  if (state.paused) toast("Motion is paused, because your system asks for less of it. Press play.");
  follow();
} else {
  Object.assign(state, { isOwn: true });
  motion.name = own.name;
  $("share").hidden = true;
  showWhatFits();
  showStatus({ notices: ["Connecting …"] });
  source.connect(told);
}
if (!drawing.stage) document.querySelector(".explains span").textContent = NO_WEBGL;
// For tests and the curious: open the console.
window.page = { DATA, Loop, source, motion, drawing, state, results, tell, enter, choose };
requestAnimationFrame(frame);
