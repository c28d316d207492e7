"""Draws the pictures of the pages anew: ``python docs/site/pictures.py [NAME ...]``.

Each picture comes from its command, function or example below. ``view.png`` shows a page in a
browser: ``furuta_ws/tests/view_picture.py`` makes it.
"""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter

import furuta
from furuta.figures.figure import style_time_series
from furuta.figures.series import draw_series
from furuta.settings.settings import load_settings, loop
from furuta.studies.swing_up import swing_up_settings
from furuta_model.state import PHI, THETA
from furuta_sim.simulation.closed_loop import Simulation

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
# Arguments of ``furuta`` by picture. OUT is the picture, DIR a folder in which it appears.
COMMANDS = {
    "axis.png": "axis --inertia 0.01 --friction "
    "alpha0=0.1,alpha1=0.1,stribeck_velocity=0.1,viscous=0.005 --pid 1 2 0.08 --out OUT",
    "branch.png": "limit-cycle --over viscous=0:0.3 --out OUT",
    "comparison.png": "compare --rigs 1000 --out OUT",
    "demo.png": "demo --out DIR",
    "describing_function.png": "limit-cycle --predict --law lugre --out OUT",
    "limit_cycle.png": "limit-cycle --out OUT",
    "map.png": "limit-cycle --over omega1=1:15 --over zeta1=0.05:1.5 --out OUT",
    "nyquist.png": "linearize --figure-4 --out OUT",
}
# Examples that draw some of the others.
EXAMPLES = {"fig9.png": "compensations", "friction_curves.png": "friction_laws"}
# The animations are in real time.
FRAMES_PER_SECOND = 20
DPI = 72
# Time of the swing-up and of its animation [s].
SECONDS, SHOWN = 8.0, 6.0
# Time until the limit cycle is there, then without and with compensation [s].
TRANSIENT, WITHOUT, WITH = 20.0, 4.0, 5.0
# Lengths in the animation: arm, pendulum, and the part of the past that the tip's path shows [s].
ARM, PENDULUM = 1.0, 0.8
PATH_TIME = 0.4


def draw_swing_up(path: Path) -> None:
    """Swing the paper's rig with a full-turn encoder up; the suffix .gif asks for the animation."""
    settings = swing_up_settings(furuta.load_rig("paper_full_turn"))
    run = furuta.simulate(loop(load_settings([], [], settings)), SECONDS)
    if path.suffix == ".gif":
        _animate(run.sample_time, run.state[: round(SHOWN / run.sample_time)], path)
    else:
        draw_series(furuta.simulated_series(run), path)


def draw_compensation(path: Path) -> None:
    """The limit cycle without compensation, which the recommended setting ends."""
    simulation = Simulation(furuta.make_loop())
    simulation.run(TRANSIENT)
    before = simulation.run(WITHOUT)
    simulation.loop = furuta.make_loop({"compensation": "recommended"})
    after = simulation.run(WITH)
    state = np.concatenate([before.state, after.state])
    _animate(before.sample_time, state, path, WITHOUT)


def _animate(sample_time: float, state: np.ndarray, path: Path, compensated: float = 0.0) -> None:
    """Write states (n, 4) as a GIF in real time; friction is ``compensated`` from that time [s]."""
    step = round(1.0 / (FRAMES_PER_SECOND * sample_time))
    figure, draw = _prepared(np.arange(len(state)) * sample_time, state)
    if compensated:
        for axis in figure.axes[1:]:
            axis.axvline(compensated, color="0.4", ls="--", lw=0.8)
        top = figure.axes[1]
        place: Any = {"y": 1.04, "transform": top.get_xaxis_transform()}
        top.text(compensated - 0.15, s="no compensation", ha="right", **place)
        top.text(compensated + 0.15, s="friction compensated", ha="left", **place)
    animation = FuncAnimation(figure, draw, frames=range(0, len(state), step), blit=False)
    animation.save(path, writer=PillowWriter(fps=FRAMES_PER_SECOND), dpi=DPI)
    plt.close(figure)


def _positions(state: np.ndarray) -> np.ndarray:
    """Centre, end of the arm and tip of the pendulum (3, 3) for a state (4,)."""
    phi, theta = float(state[PHI]), float(state[THETA])
    end = ARM * np.array((cos(phi), sin(phi), 0.0))
    across = np.array((-sin(phi), cos(phi), 0.0))
    up = np.array((0.0, 0.0, 1.0))
    return np.array((np.zeros(3), end, end + PENDULUM * (sin(theta) * across + cos(theta) * up)))


def _prepared(time: np.ndarray, state: np.ndarray) -> tuple[Any, Any]:
    """The figure, and the function that draws the sample of a frame in it."""
    figure = plt.figure(figsize=(8, 3.6), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.2))
    scene: Any = figure.add_subplot(grid[:, 0], projection="3d")
    arm_axis, pendulum_axis = figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1])
    _style_scene(scene)
    (past,) = scene.plot([], [], [], color="0.6", lw=1.0)
    (arm,) = scene.plot([], [], [], color="C0", lw=4, solid_capstyle="round")
    (pendulum,) = scene.plot([], [], [], color="C1", lw=3, marker="o", markevery=[1])
    axes, signals = (arm_axis, pendulum_axis), (PHI, THETA)
    angles = state.copy()
    angles[:, THETA] = (angles[:, THETA] + pi) % (2.0 * pi) - pi
    angles[np.abs(np.diff(angles[:, THETA], prepend=0.0)) > pi, THETA] = np.nan
    for axis, signal, label in zip(axes, signals, ("arm φ", "pendulum θ"), strict=True):
        axis.plot(time, angles[:, signal], color="0.85", lw=1.0)
        style_time_series(axis, f"{label} [rad]")
    curves = [axis.plot([], [], color=f"C{k}", lw=1.4)[0] for k, axis in enumerate(axes)]
    pendulum_axis.set_xlabel("time [s]")
    tips = np.array([_positions(each)[2] for each in state])
    length = round(PATH_TIME / time[1])

    def draw(sample: int) -> tuple[Any, ...]:
        joints = _positions(state[sample])
        arm.set_data_3d(*joints[:2].T)
        pendulum.set_data_3d(*joints[1:].T)
        past.set_data_3d(*tips[max(0, sample - length) : sample + 1].T)
        for curve, signal in zip(curves, signals, strict=True):
            curve.set_data(time[: sample + 1], angles[: sample + 1, signal])
        return arm, pendulum, past, *curves

    return figure, draw


def _style_scene(scene: Any) -> None:
    """A floor, the post of the arm, and the same scale along all axes."""
    scene.set(xlim=(-1.2, 1.2), ylim=(-1.2, 1.2), zlim=(-1.0, 1.0))
    scene.set_box_aspect((2.4, 2.4, 2.0), zoom=1.5)
    scene.view_init(elev=22, azim=-60)
    scene.set_axis_off()
    turn = np.linspace(0.0, 2.0 * pi, 100)
    scene.plot(np.cos(turn), np.sin(turn), np.zeros(100), color="0.8", lw=0.8)
    scene.plot([0, 0], [0, 0], [-1, 0], color="0.4", lw=3)


# Functions that draw the others.
DRAWINGS: dict[str, Callable[[Path], None]] = {
    "compensation.gif": draw_compensation,
    "swing-up.gif": draw_swing_up,
    "swing-up.png": draw_swing_up,
}


def draw(name: str) -> None:
    """Draw one picture of ``docs/`` anew; the old one stays if that fails."""
    if name in DRAWINGS:
        DRAWINGS[name](DOCS / name)
        return
    with tempfile.TemporaryDirectory() as folder:
        if name in EXAMPLES:
            command = [sys.executable, str(ROOT / "examples" / f"{EXAMPLES[name]}.py")]
        else:
            places = {"OUT": str(Path(folder, name)), "DIR": str(Path(folder, "results"))}
            command = ["furuta", *(places.get(word, word) for word in COMMANDS[name].split())]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, cwd=folder, check=False)
        if done.returncode:
            sys.exit(done.returncode)  # the command has said why
        (picture,) = Path(folder).rglob(f"{EXAMPLES[name]}.png" if name in EXAMPLES else name)
        shutil.copyfile(picture, DOCS / name)


if __name__ == "__main__":
    for picture in sys.argv[1:] or [*DRAWINGS, *EXAMPLES, *COMMANDS]:
        print(picture, flush=True)
        draw(picture)
