// Charts without furniture: round ticks, no frame, the colours of the names above them.
const LEFT = 40, BELOW = 30, ABOVE = 20, RIGHT = 8;
let colours;

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

// The round limit of an axis that holds a value; it shrinks only where the value has halved, so it does not flicker.
const limits = {};
function limit(name, value, least) {
  const round = (v) => step(2 * v, 4) * 2;
  const wanted = round(Math.max(least, value));
  const known = limits[name];
  limits[name] = known && wanted < known && round(Math.max(least, 1.6 * value)) >= known ? known : wanted;
  return limits[name];
}

// The names above a chart are those of its curves.
function showNames(canvas, curves) {
  for (const name of canvas.parentElement.querySelectorAll("figcaption b")) {
    name.hidden = !curves.some((curve) => curve.colour === name.dataset.curve && curve.y.some(Number.isFinite));
  }
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

// Draws curves { x, y, colour, width, symbol, isAngle } (arrays of numbers) in a canvas. Axes are symmetric about zero
// and hold all curves and `least`, or the horizontal one is given as `across`. At the `cursor` [pixels] the values stand
// of the curves that have a symbol. `axes` are the titles.
export function chart(id, curves, { across, least, axes, dot, cursor }) {
  const canvas = document.getElementById(id), scale = Math.min(2, devicePixelRatio);
  const width = canvas.clientWidth, height = canvas.clientHeight;
  const c = canvas.getContext("2d", { willReadFrequently: true });
  if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
  if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
  c.setTransform(scale, 0, 0, scale, 0, 0);
  c.clearRect(0, 0, width, height);
  showNames(canvas, curves);
  const most = (key) => curves.reduce((m, curve) => curve[key].reduce((n, v) => Math.max(n, Math.abs(v) || 0), m), 0);
  const up = limit(`${id} y`, most("y"), least.y);
  const end = across ? 0 : limit(`${id} x`, most("x"), least.x), [from, to] = across ?? [-end, end];
  const x = (v) => LEFT + ((v - from) / (to - from)) * (width - LEFT - RIGHT);
  const y = (v) => ABOVE + ((1 - v / up) / 2) * (height - ABOVE - BELOW);
  const write = (words, align, ...place) => {
    c.textAlign = align;
    c.fillText(words, ...place);
  };
  c.font = "11px system-ui, Inter, sans-serif";
  c.lineWidth = 1;
  c.fillStyle = colour("dim");
  c.strokeStyle = colour("line");
  c.textBaseline = "middle";
  for (const v of ticks(-up, up, height < 400 ? 4 : 10)) {
    c.beginPath();
    c.moveTo(LEFT, Math.round(y(v)) + 0.5);
    c.lineTo(width - RIGHT, Math.round(y(v)) + 0.5);
    c.stroke();
    write(label(v), "right", LEFT - 6, y(v));
  }
  const marks = ticks(from, to, width < 200 ? 2 : 5);
  for (const v of marks) write(label(v), "center", Math.min(x(v), width - 12), height - BELOW + 9);
  write(axes[1], "left", 4, 7);
  write(axes[0], "right", width - RIGHT, height - 7);
  c.save();
  c.beginPath();
  c.rect(LEFT, 0, width - LEFT, height - BELOW + 2);
  c.clip();
  c.lineJoin = "round";
  for (const curve of curves) {
    c.strokeStyle = colour(curve.colour);
    c.lineWidth = curve.width;
    c.beginPath();
    // An angle that passes half a turn begins a new line.
    const jumps = (values, i) => Math.abs(values[i] - values[i - 1]) > 180;
    const goesOn = (i) => i && !(curve.isAngle && (jumps(curve.x, i) || jumps(curve.y, i)));
    curve.x.forEach((v, i) => c[goesOn(i) ? "lineTo" : "moveTo"](x(v), y(curve.y[i])));
    c.stroke();
  }
  const point = (name, ...place) => {
    c.fillStyle = colour(name);
    c.beginPath();
    c.arc(...place, 4, 0, 7);
    c.fill();
  };
  if (dot) point(dot.colour, x(dot.x), y(dot.y));
  c.restore();
  if (cursor) showValues();

  function showValues() {
    const place = (a, b) => [x(a), y(b)], overTime = Boolean(across), words = [];
    for (const curve of curves.filter(({ symbol }) => symbol)) {
      const i = nearest(curve, place, cursor, overTime);
      if (i < 0) continue;
      if (!words.length) words.push(`${overTime ? "t" : curve.across} ${shown(curve.x[i])}`);
      words.push(`${curve.symbol} ${shown(curve.y[i])}`);
      point(curve.colour, ...place(curve.x[i], curve.y[i]));
    }
    c.clearRect(0, 0, width, ABOVE - 6);
    c.fillStyle = colour("ink");
    write(words.join("   "), "right", width - RIGHT, 7);
    if (!overTime) return;
    c.strokeStyle = colour("faint");
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(cursor[0], ABOVE);
    c.lineTo(cursor[0], height - BELOW);
    c.stroke();
  }
}
