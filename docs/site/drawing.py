"""The drawing of the pendulum: axes, positive directions of φ, θ and u, lengths."""

import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from furuta.figures.figure import ARM, CONTROL, FRICTION, PENDULUM, saved_figure

# Angles that are drawn [rad], lengths in units of the drawing, and the point of view [rad].
PHI, THETA = 0.75, 0.6
ARM_LENGTH, PENDULUM_LENGTH, HEIGHT = 2.1, 1.9, 1.6
AZIMUTH, ELEVATION = -0.2, 0.4
GREY = "0.55"
# Angles of the arrows of torques about the axis [rad].
TURN = np.linspace(-2.2, 1.2, 60)


def project(points: np.ndarray) -> np.ndarray:
    """Parallel projection of points (n, 3) to the plane of the paper (n, 2)."""
    x, y, z = np.atleast_2d(points).T
    right = -np.sin(AZIMUTH) * x + np.cos(AZIMUTH) * y
    depth = np.cos(AZIMUTH) * x + np.sin(AZIMUTH) * y
    return np.column_stack([right, np.cos(ELEVATION) * z - np.sin(ELEVATION) * depth])


def radial(phi: float) -> np.ndarray:
    """Direction of an arm at φ."""
    return np.array([np.cos(phi), np.sin(phi), 0.0])


def tangential(phi: float) -> np.ndarray:
    """Direction in which the arm's end moves while φ increases."""
    return np.array([-np.sin(phi), np.cos(phi), 0.0])


UP = np.array([0.0, 0.0, 1.0])
HUB = HEIGHT * UP
JOINT = HUB + ARM_LENGTH * radial(PHI)
DIRECTION = np.sin(THETA) * tangential(PHI) + np.cos(THETA) * UP
TIP = JOINT + PENDULUM_LENGTH * DIRECTION
CENTRE = JOINT + 0.55 * PENDULUM_LENGTH * DIRECTION


def draw_pendulum(path: Path) -> None:
    """Write the drawing to ``path``."""
    with saved_figure(path, figsize=(8.2, 5.0), dpi=120) as (_, axis):
        axis.set_aspect("equal")
        axis.axis("off")
        _draw_base(axis)
        _draw_angle_of_arm(axis)
        _draw_angle_of_pendulum(axis)
        _draw_bodies(axis)
        _draw_lengths(axis)
        _draw_torque(axis)
        _draw_gravity(axis)
        axis.margins(0.03)


def _line(axis: Any, *points: np.ndarray, **style: Any) -> None:
    axis.plot(*project(np.array(points)).T, **style)


def _text(axis: Any, point: np.ndarray, text: str, colour: str, **style: Any) -> None:
    x, y = project(point)[0]
    axis.text(x, y, text, color=colour, **({"ha": "center", "va": "center"} | style))


def _arrow(axis: Any, points: np.ndarray, colour: str) -> None:
    """A curve with a head at its last point."""
    flat = project(points)
    axis.plot(*flat[:-1].T, color=colour, lw=1.8)
    axis.annotate(
        "",
        flat[-1],
        flat[-3],
        arrowprops={"arrowstyle": "-|>", "color": colour, "mutation_scale": 15, "lw": 1.8},
    )


def _circle(phi: np.ndarray, radius: float, height: float) -> np.ndarray:
    """Points of a horizontal circle about the axis."""
    return np.column_stack([radius * np.cos(phi), radius * np.sin(phi), np.full(len(phi), height)])


def _draw_base(axis: Any) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 100)
    axis.fill(*project(_circle(turn, 0.62, 0.0)).T, fc="0.88", ec=GREY)
    _line(axis, 0.0 * UP, HUB, color="0.35", lw=9, solid_capstyle="butt")
    _line(axis, HUB, HUB + 1.0 * UP, color=GREY, ls="-.", lw=1)
    _text(axis, np.array([0.0, -0.7, 0.0]), "motor", "0.35", ha="right")


def _draw_angle_of_arm(axis: Any) -> None:
    _line(axis, HUB, HUB + 1.75 * radial(0.0), color=GREY, ls="--", lw=1.2)
    _text(axis, HUB + 2.02 * radial(0.0), "φ = 0", GREY)
    _arrow(axis, _circle(np.linspace(0.0, PHI, 30), 1.2, HEIGHT), ARM)
    _text(axis, HUB + 1.42 * radial(0.5 * PHI), "φ", ARM, fontsize=17)


def _draw_angle_of_pendulum(axis: Any) -> None:
    _line(axis, JOINT, JOINT + 1.75 * UP, color=GREY, ls="--", lw=1.2)
    _text(axis, JOINT + 1.9 * UP, "θ = 0: upright", GREY)
    angle = np.linspace(0.0, THETA, 30)[:, None]
    arc = JOINT + 1.3 * (np.sin(angle) * tangential(PHI) + np.cos(angle) * UP)
    _arrow(axis, arc, PENDULUM)
    middle = np.sin(0.5 * THETA) * tangential(PHI) + np.cos(0.5 * THETA) * UP
    _text(axis, JOINT + 1.48 * middle, "θ", PENDULUM, fontsize=17)


def _draw_bodies(axis: Any) -> None:
    _line(axis, HUB, JOINT, color=ARM, lw=7, solid_capstyle="round")
    _line(axis, JOINT, TIP, color=PENDULUM, lw=5.5, solid_capstyle="round")
    for point, size in ((HUB, 13), (JOINT, 11)):
        _line(axis, point, marker="o", ms=size, mfc="white", mec="0.3", mew=2)
    _line(axis, CENTRE, marker="o", ms=10, mfc="white", mec="0.2", mew=1.5)
    _line(axis, CENTRE, marker=".", ms=5, color="0.2")


def _draw_lengths(axis: Any) -> None:
    """Dimension lines beside the bodies: L above the arm, l beside the pendulum."""
    for start, end, offset, text in (
        (HUB, JOINT, 0.3 * UP, "L"),
        (JOINT, CENTRE, 0.42 * (np.cos(THETA) * tangential(PHI) - np.sin(THETA) * UP), "l"),
    ):
        ends = project(np.array([start + offset, end + offset]))
        axis.annotate("", *ends, arrowprops={"arrowstyle": "<->", "color": "0.3", "lw": 1})
        for point in (start, end):
            _line(axis, point, point + 1.15 * offset, color="0.7", lw=0.8, zorder=0)
        _text(axis, 0.5 * (start + end) + 1.55 * offset, text, "0.2", style="italic", fontsize=15)


def _draw_torque(axis: Any) -> None:
    """The control u in the direction of φ, and friction F against it while the arm moves so."""
    _arrow(axis, _circle(TURN, 0.5, HEIGHT + 0.65), CONTROL)
    _text(axis, HUB + np.array([0.0, -0.68, 0.65]), "u", CONTROL, fontsize=17)
    _arrow(axis, _circle(TURN[::-1], 0.5, 0.42), FRICTION)
    _text(axis, np.array([0.0, -0.68, 0.42]), "F", FRICTION, fontsize=17)


def _draw_gravity(axis: Any) -> None:
    top = CENTRE - 0.12 * UP
    points = np.linspace(top, top - 0.42 * UP, 10)
    _arrow(axis, points, "0.2")
    _text(
        axis,
        points[-1] - 0.12 * UP - 0.12 * tangential(PHI),
        "mg",
        "0.2",
        style="italic",
        fontsize=12,
    )


if __name__ == "__main__":
    plt.switch_backend("agg")
    draw_pendulum(Path(sys.argv[1]))
