// Charts without furniture: round ticks, no frame, the colours of the names above them.
const LEFT = 40, BELOW = 18, ABOVE = 8, RIGHT = 8;
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

// The round limit of an axis that holds a value; it shrinks only where the value has halved, so it does not flicker.
const limits = {};
function limit(name, value, least) {
  const round = (v) => step(2 * v, 4) * 2;
  const wanted = round(Math.max(least, value));
  const known = limits[name];
  limits[name] = known && wanted < known && round(Math.max(least, 1.6 * value)) >= known ? known : wanted;
  return limits[name];
}

// Draws curves { x, y, colour, width } (arrays of numbers) in a canvas. Axes are symmetric about zero and hold all curves
// and `least`, or the horizontal one is given as `across`.
export function chart(id, curves, { across, least, units, dot }) {
  const canvas = document.getElementById(id), scale = Math.min(2, devicePixelRatio);
  const width = canvas.clientWidth, height = canvas.clientHeight;
  const c = canvas.getContext("2d", { willReadFrequently: true });
  if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
  if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
  c.setTransform(scale, 0, 0, scale, 0, 0);
  c.clearRect(0, 0, width, height);
  const most = (key) => curves.reduce((m, curve) => curve[key].reduce((n, v) => Math.max(n, Math.abs(v) || 0), m), 0);
  const up = limit(`${id} y`, most("y"), least.y);
  const [from, to] = across ?? [-limit(`${id} x`, most("x"), least.x), limit(`${id} x`, most("x"), least.x)];
  const x = (v) => LEFT + ((v - from) / (to - from)) * (width - LEFT - RIGHT);
  const y = (v) => ABOVE + ((1 - v / up) / 2) * (height - ABOVE - BELOW);
  c.font = "11px system-ui, Inter, sans-serif";
  c.lineWidth = 1;
  c.fillStyle = colour("dim");
  c.strokeStyle = colour("line");
  c.textBaseline = "middle";
  c.textAlign = "right";
  for (const v of ticks(-up, up, 4)) {
    c.beginPath();
    c.moveTo(LEFT, Math.round(y(v)) + 0.5);
    c.lineTo(width - RIGHT, Math.round(y(v)) + 0.5);
    c.stroke();
    c.fillText(label(v), LEFT - 6, y(v));
  }
  c.textAlign = "center";
  const marks = ticks(from, to, width < 200 ? 2 : 5);
  for (const v of marks) c.fillText(label(v), Math.min(x(v), width - 12), height - 6);
  c.textAlign = "left";
  c.fillText(units[1], LEFT + 3, ABOVE + 7);
  c.textAlign = "right";
  c.fillText(units[0], width, height - BELOW - 7);
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
    const goesOn = (i) => i && Math.abs(curve.y[i] - curve.y[i - 1]) < 180;
    curve.x.forEach((v, i) => c[goesOn(i) ? "lineTo" : "moveTo"](x(v), y(curve.y[i])));
    c.stroke();
  }
  if (dot) {
    c.fillStyle = colour(dot.colour);
    c.beginPath();
    c.arc(x(dot.x), y(dot.y), 4, 0, 7);
    c.fill();
  }
  c.restore();
}
