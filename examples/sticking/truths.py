"""Compute the exact values of scenes.json by two methods, write them, and draw the scenes.

tools/in_environment python examples/sticking/truths.py            # compares both methods
tools/in_environment python examples/sticking/truths.py --write    # also scenes.json, scenes.png

The first method is the library's (the motion of a linear loop in closed form or by its own
integrator, and the limit cycle by Newton's method) or a formula. The second one knows only
scenes.json and its torque, and integrates from event to event with DOP853 of scipy.
"""

import json
import re
import sys
from collections import defaultdict
from collections.abc import Callable
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from run import FILE, HERE, Scene, torque
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import furuta
from furuta.limit_cycles.exact_motion import follow_piece, state_after
from furuta.limit_cycles.friction_loop import first_mode, next_mode
from furuta.limit_cycles.joint import joint
from furuta.limit_cycles.smooth_motion import AT_REST, EVENT, extent_at

# --- The first method ------------------------------------------------------------------------


def by_library(scene: Scene) -> list[float]:
    """The measured values, from the library or a formula."""
    first, given = scene["measured"][0], scene["torque"]
    if "gravity" in scene["parameters"]:
        return [_stops(scene)]
    if scene["law"] == "stribeck":
        gains = furuta.Pid(given["kp"], given["ki"], given["kd"])
        cycle = furuta.servo_cycle(_axis(scene), gains, given.get("speed", 0.0))
        return [cycle.peak_to_peak, cycle.period_s]
    if first["what"] == "passes":
        passed = lambda t: _moved(scene, t)[1] - first["angle"]  # noqa: E731
        return [brentq(passed, 0.1, scene["seconds"], xtol=1e-13)]
    if first["what"] == "angle":
        return [_moved(scene, scene["seconds"])[1]]
    v, q = np.array([_moved(scene, t)[:2] for t in np.linspace(first["from"], scene["seconds"])]).T
    return [float(np.ptp(q) if first["what"] == "peak_to_peak" else np.abs(v).max())]


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


def _moved(scene: Scene, seconds: float) -> np.ndarray:
    """Speed, angle and more after ``seconds``, by the library's motion of a linear loop."""
    p, axis = defaultdict(float, scene["torque"]), _axis(scene)
    w, start = 2.0 * np.pi * p["frequency"], scene["start"]
    # Over v, q, the integral of e, the time, and sine and cosine, as far as they are needed.
    a, r = np.zeros((6, 6)), np.zeros(6)
    a[0] = [-p["kd"], -p["kp"], p["ki"], p["rate"], p["amplitude"], 0.0]
    r[0], a[0], r[3] = p["constant"] / axis.inertia, a[0] / axis.inertia, 1.0
    a[1, 0], a[2, 1], a[4, 5], a[5, 4] = 1.0, -1.0, w, -w
    used = np.array([True, True, "ki" in p, "rate" in p, w > 0.0, w > 0.0])
    x = np.array([start["speed"], start["angle"], 0.0, 0.0, 0.0, 1.0])[used]
    first = np.eye(len(x))[0]
    given = joint(a[used][:, used], first / axis.inertia, first, axis.friction, axis.law, r[used])
    y, left, rows = given.state(x), seconds / given.units.time, np.empty((0, len(x) + 3))
    mode = first_mode(y, given.loop)
    while True:
        before = y.copy()
        ended, duration, _ = follow_piece(y, mode, left, extent_at(y), rows, given.loop)
        if ended != EVENT or duration >= left:
            y = y if ended == AT_REST else state_after(before, mode, left, given.loop)
            return given.units.basis @ y[1:-1]
        left -= duration
        mode = next_mode(y, mode, given.loop)


def _stops(scene: Scene) -> float:
    """Where weight and friction have used up the kinetic energy; friction then holds it."""
    p, angle = scene["parameters"], scene["start"]["angle"]
    energy = 0.5 * p["inertia"] * scene["start"]["speed"] ** 2 + p["gravity"] * np.cos(angle)
    left = lambda q: energy - p["gravity"] * np.cos(q) - p["coulomb"] * (angle - q)  # noqa: E731
    stop = float(brentq(left, 0.0, angle, xtol=1e-15))
    assert p["gravity"] * np.sin(stop) < p["coulomb"]
    return stop


# --- The second method -----------------------------------------------------------------------


class Motion(NamedTuple):
    """Pieces (start, end, state over time), and the events: time, state, mode that ends there.

    The state is q, v, the integral of e, and the bristle. An extreme of e has no mode.
    """

    pieces: list[tuple[float, float, Callable[[float], np.ndarray]]]
    events: list[tuple[float, np.ndarray, float]]


def by_events(scene: Scene) -> list[float]:
    """The measured values, from piece to piece of the motion that scenes.json describes."""
    found = motion(scene)
    return [_value(found, scene, measured) for measured in scene["measured"]]


def _value(found: Motion, scene: Scene, measured: dict[str, Any]) -> float:
    what, since = measured["what"], measured.get("from", 0.0)
    if what == "passes":
        over = lambda t, f: f(t)[0] - measured["angle"]  # noqa: E731
        t0, t1, f = next(piece for piece in found.pieces if over(piece[1], piece[2]) > 0.0)
        return float(brentq(over, t0, t1, (f,), xtol=1e-14))
    if what == "period":
        ends = [t for t, _, mode in found.events if mode > 0.0 and t > since]
        return float(np.mean(np.diff(ends)))
    if what == "peak_to_peak":
        speed = scene["torque"].get("speed", 0.0)
        points = [(since, f(since)) for t0, t1, f in found.pieces if t0 <= since <= t1]
        points += [(t, y) for t, y, _ in found.events if t >= since]
        return float(np.ptp([speed * t - y[0] for t, y in points]))
    if what == "fastest":
        late = [f(t)[1] for _, t1, f in found.pieces for t in np.linspace(since, t1) if t1 > since]
        return float(np.abs(late).max())
    return float(found.events[-1][1][0])


def motion(scene: Scene) -> Motion:
    """The whole motion of a scene."""
    p, law = defaultdict(float, scene["parameters"]), scene["law"]
    speed, end = scene["torque"].get("speed", 0.0), scene["seconds"]

    def push(t: float, y: np.ndarray) -> float:
        return torque(scene, t, *y[:3]) + p["gravity"] * np.sin(y[0])

    def level(t: float, y: np.ndarray, side: float, v: float) -> float:
        fall = np.exp(-((v / p["stribeck_speed"]) ** 2)) if p["stribeck_speed"] else 0.0
        load = p["load"] * abs(torque(scene, t, *y[:3]))
        base = p["coulomb"] * (1.0 + side * p["asymmetry"]) + load
        return base + (p["static"] - p["coulomb"]) * fall

    def rate(t: float, y: np.ndarray, mode: float) -> list[float]:
        q, v, _, z = y
        friction, stretch = mode * level(t, y, mode, v), 0.0
        if law == "lugre":
            stretch = v * (1.0 - p["stiffness"] * z / friction)
            friction = p["stiffness"] * z + p["damping"] * stretch
        a = (push(t, y) - friction - p["viscous"] * v) / p["inertia"]
        return [v, a if mode else 0.0, speed * t - q, stretch]

    def excess(t: float, y: np.ndarray, side: float) -> float:
        return side * push(t, y) - (p["static"] if law == "static" else level(t, y, side, 0.0))

    def following(t: float, y: np.ndarray, mode: float) -> float:
        if y[1] != 0.0:
            return float(np.sign(y[1]))
        if law == "lugre":
            return -mode or 1.0
        edge = 0.0 if mode else -1e-9 * p["coulomb"]
        return next((side for side in (1.0, -1.0) if excess(t, y, side) > edge), 0.0)

    y = np.array([scene["start"]["angle"], scene["start"]["speed"], 0.0, 0.0])
    t, found = 0.0, Motion([], [])
    mode = following(t, y, 0.0)
    while t < end:
        stops = [lambda t, y, m=mode: m * y[1]]
        if not mode:
            stops = [lambda t, y, side=side: -excess(t, y, side) for side in (1.0, -1.0)]
        for stop in stops:
            stop.terminal, stop.direction = True, -1.0  # type: ignore[attr-defined]
        extreme = lambda t, y: y[1] - speed  # noqa: E731
        path = solve_ivp(
            lambda t, y, m=mode: rate(t, y, m), (t, end), y, "DOP853", dense_output=True,
            events=[*stops, extreme], rtol=1e-12, atol=1e-16, max_step=0.05,
        )  # fmt: skip
        found.pieces.append((t, path.t[-1], path.sol))
        found.events.extend((at, path.sol(at), np.nan) for at in path.t_events[-1])
        t, y = path.t[-1], path.y[:, -1].copy()
        y[1] = 0.0 if path.status == 1 else y[1]
        found.events.append((t, y, mode if path.status == 1 else np.nan))
        mode = following(t, y, mode)
    return found


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


def write(scenes: list[Scene]) -> None:
    """Put the exact values into scenes.json, and draw scenes.png."""
    text = (HERE / "scenes.json").read_text()
    for scene in scenes:
        before, name, after = text.partition(f'"name": "{scene["name"]}"')
        line = f'"measured": {json.dumps(scene["measured"])},'
        text = before + name + re.sub(r'"measured": .*', line, after, count=1)
    (HERE / "scenes.json").write_text(text)
    figure, axes = plt.subplots(3, 4, figsize=(12.0, 7.5), layout="constrained")
    for panel, scene in zip(axes.flat, scenes, strict=True):
        for t0, t1, path in motion(scene).pieces:
            t = np.linspace(t0, t1, 100)
            panel.plot(t, [path(each)[0] for each in t], "C0")
        panel.set_title(scene["title"], fontsize=9)
        panel.set(xlabel="time [s]", ylabel="angle [rad]")
    figure.savefig(HERE / "scenes.png", dpi=70)


if __name__ == "__main__":
    for scene in FILE["scenes"]:
        for each, (exact, bound) in zip(scene["measured"], compared(scene), strict=True):
            each |= {"exact": exact, "error": bound, "scale": each["scale"] or abs(exact)}
            print(f"{scene['name']:11} {each['what']:13} {exact:.12g} ± {bound:.0e}")
    if "--write" in sys.argv:
        write(FILE["scenes"])
