// Charts without furniture: round ticks, no frame, the colours of the names above them.
let colours;

// Space around the curves for a size of text [pixels].
const spaces = (size) => ({ left: 3.6 * size, below: 2.7 * size, above: 1.8 * size, right: 8 });

// Colours are read anew after a change between dark and light.
export function forgetColours() {
  colours = undefined;
}

function colour(name) {
  colours ??= getComputedStyle(document.documentElement);
  return colours.getPropertyValue(`--${name}`).trim();
}

// A step of 1, 2 or 5 times a power of ten, of which a range holds at most n.
function step(range, n) {
  const power = 10 ** Math.floor(Math.log10(range / n));
  return power * [1, 2, 5, 10].find((each) => each * power * n >= range * (1 - 1e-9));
}

function ticks(from, to, n) {
  const size = step(to - from, n), found = [];
  for (let k = Math.ceil(from / size - 1e-9); k * size <= to + 1e-9; k++) found.push(k * size);
  return found;
}

export const text = (value, digits) => value.toFixed(digits).replace("-", "−").replace(/^−(0\.?0*)$/, "$1");

const label = (value) => String(Number(value.toPrecision(6))).replace("-", "−");
const shown = (value) => (Number.isFinite(value) ? text(value, Math.abs(value) < 10 ? 2 : 1) : "–");

const valued = (value, unit) => `${shown(value)}${unit === "°" ? "" : " "}${unit}`;

// The round limit of an axis that holds a value; it shrinks only where the value has halved, so it does not flicker.
const limits = {};
function limit(name, value, least) {
  const round = (v) => step(2 * v, 4) * 2;
  const wanted = round(Math.max(least, value));
  const known = limits[name];
  limits[name] = known && wanted < known && round(Math.max(least, 1.6 * value)) >= known ? known : wanted;
  return limits[name];
}

// The names above a chart are those of its curves, with the values at a place if there is one: `at` has the words of
// the axis across, and the index of the point.
function showNames(canvas, curves, at) {
  const caption = canvas.parentElement.querySelector("figcaption");
  for (const name of caption.querySelectorAll("b")) {
    const curve = curves.find(({ colour: own, y }) => own === name.dataset.curve && y.some(Number.isFinite));
    name.hidden = !curve || (at && !curve.symbol);
    if (curve) name.dataset.value = at && curve.symbol ? `${curve.symbol} ${valued(curve.y[at.i], curve.unit)}` : "";
  }
  caption.dataset.at = at ? at.words : "";
}

// The point of a curve next to a place: across alone over time, or in the plane.
function nearest({ x, y }, place, [px, py], overTime) {
  let best = -1, least = Infinity;
  for (let i = 0; i < x.length; i++) {
    const [cx, cy] = place(x[i], y[i]), distance = overTime ? Math.abs(cx - px) : Math.hypot(cx - px, cy - py);
    if (distance < least) [best, least] = [i, distance];
  }
  return best;
}

// Draws curves { x, y, colour, width, dash, symbol, unit, isAngle } (arrays of numbers) in a canvas. Axes are symmetric
// about zero and hold all curves and `least`, or the horizontal one is given as `across`. The names above get the values
// of the point with index `at`, or else of that next to the `cursor` [pixels], of the curves that have a symbol; these
// have points of the same moments. `axes` are the titles. Returns the index of the point next to the cursor.
export function chart(id, curves, { across, least, axes, dot, cursor, at }) {
  const canvas = document.getElementById(id), scale = Math.min(2, devicePixelRatio);
  const width = canvas.clientWidth, height = canvas.clientHeight;
  const c = canvas.getContext("2d", { willReadFrequently: true }), size = Number.parseFloat(getComputedStyle(canvas).fontSize);
  const { left, below, above, right } = spaces(size), overTime = Boolean(across);
  if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
  if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
  c.setTransform(scale, 0, 0, scale, 0, 0);
  c.clearRect(0, 0, width, height);
  const most = (key) => curves.reduce((m, curve) => curve[key].reduce((n, v) => Math.max(n, Math.abs(v) || 0), m), 0);
  const up = limit(`${id} y`, most("y"), least.y);
  const end = across ? 0 : limit(`${id} x`, most("x"), least.x), [from, to] = across ?? [-end, end];
  const x = (v) => left + ((v - from) / (to - from)) * (width - left - right);
  const y = (v) => above + ((1 - v / up) / 2) * (height - above - below);
  const write = (words, align, ...place) => {
    c.textAlign = align;
    c.fillText(words, ...place);
  };
  c.font = `${size}px system-ui, Inter, sans-serif`;
  c.lineWidth = 1;
  c.fillStyle = colour("dim");
  c.strokeStyle = colour("line");
  c.textBaseline = "middle";
  for (const v of ticks(-up, up, height < 36 * size ? 4 : 10)) {
    c.beginPath();
    c.moveTo(left, Math.round(y(v)) + 0.5);
    c.lineTo(width - right, Math.round(y(v)) + 0.5);
    c.stroke();
    write(label(v), "right", left - 6, y(v));
  }
  const marks = ticks(from, to, width < 18 * size ? 2 : 5);
  for (const v of marks) write(label(v), "center", Math.min(x(v), width - 1.1 * size), height - below + 0.8 * size);
  write(axes[1], "left", 4, 0.65 * size);
  c.save();
  c.beginPath();
  c.rect(left, 0, width - left, height - below + 2);
  c.clip();
  c.lineJoin = "round";
  for (const curve of curves) {
    c.strokeStyle = colour(curve.colour);
    c.lineWidth = (curve.width * size) / 11;
    c.setLineDash(curve.dash ?? []);
    c.beginPath();
    // An angle that passes half a turn begins a new line.
    const jumps = (values, i) => Math.abs(values[i] - values[i - 1]) > 180;
    const goesOn = (i) => i && !(curve.isAngle && (jumps(curve.x, i) || jumps(curve.y, i)));
    curve.x.forEach((v, i) => c[goesOn(i) ? "lineTo" : "moveTo"](x(v), y(curve.y[i])));
    c.stroke();
  }
  c.setLineDash([]);
  const point = (name, ...place) => {
    c.fillStyle = colour(name);
    c.beginPath();
    c.arc(...place, 0.36 * size, 0, 7);
    c.fill();
  };
  if (dot) point(dot.colour, x(dot.x), y(dot.y));
  c.restore();
  const named = curves.filter(({ symbol, y: values }) => symbol && values.some(Number.isFinite)), [first] = named;
  const under = first && cursor ? nearest(first, (a, b) => [x(a), y(b)], cursor, overTime) : -1, i = at ?? under;
  const isMarked = first && i >= 0, words = isMarked ? `${first.across} ${valued(first.x[i], first.unitAcross)}` : axes[0];
  c.fillStyle = colour(isMarked ? "ink" : "dim");
  write(words, "right", width - right, height - 0.65 * size);
  showNames(canvas, curves, isMarked && { i, words });
  if (!isMarked) return null;
  for (const curve of named) point(curve.colour, x(curve.x[i]), y(curve.y[i]));
  if (overTime) {
    c.strokeStyle = colour("faint");
    c.beginPath();
    c.moveTo(x(first.x[i]), above);
    c.lineTo(x(first.x[i]), height - below);
    c.stroke();
  }
  return under < 0 ? null : under;
}
