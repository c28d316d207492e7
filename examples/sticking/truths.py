"""Compute the exact values of scenes.json by two methods, write them, and draw the scenes.

tools/in_environment python examples/sticking/truths.py           # compares both methods
tools/in_environment python examples/sticking/truths.py --write   # also writes scenes.json, scenes.png

The first method is the library's (the motion of a linear loop in closed form or by its own
integrator, and the limit cycle by Newton's method) or a formula. The second one knows only
scenes.json, and integrates from event to event with scipy's DOP853.
"""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import furuta
from furuta.axis.axis import servo_cycle
from furuta.limit_cycles.exact_motion import follow_piece, state_after
from furuta.limit_cycles.friction_loop import first_mode, next_mode
from furuta.limit_cycles.joint import joint
from furuta.limit_cycles.smooth_motion import AT_REST, EVENT, extent_at

HERE = Path(__file__).parent
Scene = dict[str, Any]
TORQUES = ("constant", "rate", "amplitude", "frequency", "kp", "ki", "kd", "speed")


class Torque(NamedTuple):
    """Terms of the torque, as scenes.json explains them."""

    constant: float = 0.0
    rate: float = 0.0
    amplitude: float = 0.0
    frequency: float = 0.0
    kp: float = 0.0
    ki: float = 0.0
    kd: float = 0.0
    speed: float = 0.0

    def at(self, t: float, q: float, v: float, integral: float) -> float:
        """The torque [N m]; ``integral`` is that of e."""
        wave = self.amplitude * np.sin(2.0 * np.pi * self.frequency * t)
        control = self.kp * (self.speed * t - q) + self.ki * integral + self.kd * (self.speed - v)
        return self.constant + self.rate * t + wave + control


# --- The first method ------------------------------------------------------------------------


def by_library(scene: Scene) -> list[float]:
    """The measured values, from the library or a formula."""
    if scene["name"] == "pendulum":
        return [_pendulum_stops(scene)]
    torque, axis = Torque(**scene["torque"]), _axis(scene)
    if scene["law"] == "stribeck":
        gains = furuta.Pid(torque.kp, torque.ki, torque.kd)
        cycle = servo_cycle(axis, gains, torque.speed)
        return [cycle.peak_to_peak, cycle.period_s]
    [measured] = scene["measured"]
    if measured["what"] == "passes":
        late = lambda t: _moved(scene, t)[0] - measured["angle"]  # noqa: E731
        return [brentq(late, 0.1, scene["seconds"], xtol=1e-13, rtol=1e-14)]
    if measured["what"] == "peak_to_peak":
        times = np.linspace(measured["from"], scene["seconds"], 200)
        return [float(np.ptp([_moved(scene, t)[0] for t in times]))]
    return [_moved(scene, scene["seconds"])[measured["what"] == "speed"]]


def _axis(scene: Scene) -> furuta.Axis:
    p, law = scene["parameters"], scene["law"]
    level = p["coulomb"] + p.get("load", 0.0) * abs(scene["torque"].get("constant", 0.0))
    friction = furuta.Friction(
        sigma0=p.get("stiffness", 0.0),
        sigma1=p.get("damping", 0.0),
        alpha0=level,
        alpha1=p.get("static", level) - level,
        stribeck_velocity=p.get("stribeck_speed", 0.1),
        viscous=p.get("viscous", 0.0),
        asymmetry=p.get("asymmetry", 0.0),
    )
    names = {"static": "stiction", "asymmetric": "coulomb", "load": "coulomb"}
    return furuta.Axis(p["inertia"], friction, names.get(law, law))


def _moved(scene: Scene, seconds: float) -> tuple[float, float]:
    """Angle and speed after ``seconds``, by the library's motion of a linear loop."""
    p, axis, w = Torque(**scene["torque"]), _axis(scene), 2.0 * np.pi
    w *= p.frequency
    # Over v, q, the integral of e, the time, and sine and cosine.
    a, r = np.zeros((6, 6)), np.zeros(6)
    a[0] = np.array([-p.kd, -p.kp, p.ki, p.rate + p.kp * p.speed, p.amplitude, 0.0]) / axis.inertia
    r[0] = (p.constant + p.kd * p.speed) / axis.inertia
    a[1, 0], a[2, 1], a[2, 3], r[3], a[4, 5], a[5, 4] = 1.0, -1.0, p.speed, 1.0, w, -w
    start = np.array([scene["start"]["speed"], scene["start"]["angle"], 0.0, 0.0, 0.0, 1.0])
    used = [True, True, bool(p.ki), bool(p.rate or p.speed), bool(w), bool(w)]
    b = np.append(1.0 / axis.inertia, np.zeros(sum(used) - 1))
    c = np.append(1.0, np.zeros(len(b) - 1))
    given = joint(a[used][:, used], b, c, axis.friction, axis.law, r[used])
    y, left, rows = given.state(start[used]), seconds / given.units.time, np.empty((0, len(b) + 3))
    mode = first_mode(y, given.loop)
    while True:
        start = y.copy()
        ended, duration, _ = follow_piece(y, mode, left, extent_at(y), rows, given.loop)
        if ended != EVENT or duration >= left:
            y = y if ended == AT_REST else state_after(start, mode, left, given.loop)
            break
        left -= duration
        mode = next_mode(y, mode, given.loop)
    x = given.units.basis @ y[1:-1]
    return float(x[1]), float(x[0])


def _pendulum_stops(scene: Scene) -> float:
    """Where kinetic energy is used up by weight and friction; friction then holds it."""
    p, start = scene["parameters"], scene["start"]
    energy = 0.5 * p["inertia"] * start["speed"] ** 2

    def left(q: float) -> float:
        raised = p["gravity"] * (np.cos(q) - np.cos(start["angle"]))
        return float(energy - raised - p["coulomb"] * (start["angle"] - q))

    stop = float(brentq(left, 0.0, start["angle"], xtol=1e-15))
    assert p["gravity"] * np.sin(stop) < p["coulomb"]
    return stop


# --- The second method -----------------------------------------------------------------------


class Path_(NamedTuple):
    """Times, states (q, v, integral, bristle) and modes at the ends of the pieces of a motion."""

    ends: list[tuple[float, np.ndarray, float]]
    pieces: list[tuple[float, float, Callable[[float], np.ndarray]]]


def by_events(scene: Scene) -> list[float]:
    """The measured values, from piece to piece of the motion that scenes.json describes."""
    path, values = motion(scene), []
    for measured in scene["measured"]:
        what, since = measured["what"], measured.get("from", 0.0)
        if what in ("angle", "speed"):
            values.append(float(path.ends[-1][1][int(what == "speed")]))
        elif what == "passes":
            above = lambda t, f: f(t)[0] - measured["angle"]  # noqa: E731
            t0, t1, f = next(piece for piece in path.pieces if above(piece[1], piece[2]) > 0.0)
            values.append(float(brentq(above, t0, t1, (f,), xtol=1e-14)))
        elif what == "period":
            stops = [t for t, _, mode in path.ends if mode == 1.0 and t > since]
            values.append(float(np.mean(np.diff(stops))))
        else:
            values.append(_peak_to_peak(path, scene["torque"].get("speed", 0.0), since))
    return values


def motion(scene: Scene) -> Path_:
    """The whole motion: from an event to the next."""
    p, torque, lugre = scene["parameters"], Torque(**scene["torque"]), scene["law"] == "lugre"
    y = np.array([scene["start"]["angle"], scene["start"]["speed"], 0.0, 0.0])
    t, path = 0.0, Path_([], [])

    def push(t: float, y: np.ndarray) -> float:
        return torque.at(t, *y[:3]) + p.get("gravity", 0.0) * np.sin(y[0])

    def levels(t: float, y: np.ndarray, mode: float, v: float) -> float:
        level = p["coulomb"] * (1.0 + mode * p.get("asymmetry", 0.0))
        level += p.get("load", 0.0) * abs(torque.at(t, *y[:3]))
        if "stribeck_speed" in p:
            level += (p["static"] - p["coulomb"]) * np.exp(-((v / p["stribeck_speed"]) ** 2))
        return level

    def rate(t: float, y: np.ndarray, mode: float) -> list[float]:
        q, v, _, z = y
        stretch = 0.0
        if lugre:
            stretch = v * (1.0 - mode * p["stiffness"] * z / levels(t, y, mode, v))
            friction = p["stiffness"] * z + p["damping"] * stretch
        else:
            friction = mode * levels(t, y, mode, v)
        a = (push(t, y) - friction - p.get("viscous", 0.0) * v) / p["inertia"]
        sticks = mode == 0.0
        return [0.0 if sticks else v, 0.0 if sticks else a, torque.speed * t - q, stretch]

    def breaks(t: float, y: np.ndarray, side: float) -> float:
        level = p["static"] if scene["law"] == "static" else levels(t, y, side, 0.0)
        return side * push(t, y) - level

    def next_mode(t: float, y: np.ndarray, mode: float) -> float:
        if y[1] != 0.0:
            return float(np.sign(y[1]))
        if lugre:
            return -mode or float(np.sign(rate(1e-9, y, 1.0)[1] or 1.0))
        edge = 1e-9 * p["coulomb"] * (1.0 if mode == 0.0 else 0.0)
        return next((side for side in (1.0, -1.0) if breaks(t, y, side) > -edge), 0.0)

    mode = next_mode(t, y, 0.0) if y[1] == 0.0 else float(np.sign(y[1]))
    while t < scene["seconds"]:
        if mode == 0.0:
            ends = [lambda t, y, s=side: breaks(t, y, s) for side in (1.0, -1.0)]
        else:
            ends = [lambda t, y, m=mode: m * y[1]]
        for end in ends:
            end.terminal, end.direction = True, -1.0 if mode else 1.0  # type: ignore[attr-defined]
        extreme = lambda t, y: y[1] - torque.speed  # noqa: E731
        limits = {"rtol": 1e-12, "atol": 1e-16, "max_step": 0.05}
        run = solve_ivp(
            lambda t, y, m=mode: rate(t, y, m), (t, scene["seconds"]), y, "DOP853",
            dense_output=True, events=[*ends, extreme], **limits,
        )
        path.pieces.append((t, run.t[-1], run.sol))
        path.ends.extend((at, run.sol(at), np.nan) for at in run.t_events[-1])
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.status == 1:
            y[1] = 0.0
            path.ends.append((t, y, mode))
            mode = next_mode(t, y, mode)
    path.ends.append((t, y, np.nan))
    return path


def _peak_to_peak(path: Path_, speed: float, since: float) -> float:
    first = next(f(since) for t0, t1, f in path.pieces if t0 <= since <= t1)
    points = [(since, first), *((t, y) for t, y, _ in path.ends if t >= since)]
    return float(np.ptp([speed * t - y[0] for t, y in points]))


def compared(scene: Scene) -> list[tuple[float, float]]:
    """Each exact value with its error: the difference of both methods, rounded up to a decade."""
    found = []
    for one, other, measured in zip(
        by_library(scene), by_events(scene), scene["measured"], strict=True
    ):
        scale = measured["scale"] or abs(other)
        error = 10.0 ** np.ceil(np.log10(max(2.0 * abs(one - other), 1e-9 * scale)))
        assert error <= 1e-6 * scale, f"{scene['name']}: {one} and {other} differ"
        found.append((round(other, -round(np.log10(error))), float(error)))
    return found


def write(file: dict[str, Any]) -> None:
    """Put exact values and errors into scenes.json: one line for each that is measured."""
    path = HERE / "scenes.json"
    lines = path.read_text().splitlines()
    for scene in file["scenes"]:
        line = next(k for k, text in enumerate(lines) if f'"name": "{scene["name"]}"' in text)
        line = next(k for k in range(line, len(lines)) if '"measured"' in lines[k])
        lines[line] = f'      "measured": {json.dumps(scene["measured"])},'
    path.write_text("\n".join(lines) + "\n")


def draw(scenes: list[Scene]) -> None:
    """The exact motion of each scene: angle, or e behind a reference, and torque over level."""
    import matplotlib.pyplot as plt  # noqa: PLC0415 - only for the picture

    figure, axes = plt.subplots(4, 3, figsize=(10.0, 10.0), layout="constrained")
    for panel, scene in zip(axes.flat, scenes, strict=True):
        speed, start = scene["torque"].get("speed", 0.0), scene["measured"][0].get("from", 0.0)
        for t0, t1, piece in motion(scene).pieces:
            t = np.linspace(t0, t1, 100)
            panel.plot(t, [piece(each)[0] for each in t], "C0")
        panel.set(title=scene["title"], xlabel="s", ylabel="rad")
    figure.savefig(HERE / "scenes.png", dpi=80)


if __name__ == "__main__":
    FILE = json.loads((HERE / "scenes.json").read_text())
    for scene in FILE["scenes"]:
        for each, (exact, bound) in zip(scene["measured"], compared(scene), strict=True):
            each |= {"exact": exact, "error": bound, "scale": each["scale"] or abs(exact)}
            print(f"{scene['name']:11} {each['what']:13} {exact:.12g} ± {bound:.0e}")
    if "--write" in sys.argv:
        write(FILE)
        draw(FILE["scenes"])
