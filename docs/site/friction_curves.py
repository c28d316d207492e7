"""Friction over the arm's speed: steady, at rest, and with a bristle in an oscillation."""

from pathlib import Path
from typing import Any

import numpy as np

from furuta.figures.figure import FAINT_GRID, legend_outside, saved_figure, style_axis
from furuta_model.friction.laws import (
    ANALYSED_LAWS,
    FrictionLaw,
    breakaway_level,
    bristle_force,
    friction_law,
    steady_friction,
)
from furuta_model.friction.parameters import Friction

# Largest speed shown, in Stribeck velocities.
LARGEST_SPEED = 4.0
# Angular frequency of the oscillation of laws with a bristle [rad/s], and its samples.
OSCILLATION = 3.0
SAMPLES = 20_000
STEADY, REST, MOVING = "tab:blue", "tab:red", "tab:green"


def draw_friction_laws(path: Path) -> None:
    """Draw one panel per law without springs, with the paper's parameters."""
    shared: dict[str, Any] = {"sharex": True, "sharey": True, "figsize": (13, 4.2)}
    with saved_figure(path, 1, len(ANALYSED_LAWS), **shared) as (figure, axes):
        for name, axis in zip(ANALYSED_LAWS, axes, strict=True):
            law = friction_law(name, Friction())
            _draw_steady_sliding(axis, law)
            if law.bristle:
                _draw_oscillation(axis, law)
            else:
                _draw_rest(axis, law)
            axis.set_title(law.name)
            style_axis(axis, "arm speed v [rad/s]", grid=FAINT_GRID)
        axes[0].set_ylabel("friction F [V]")
        handles = {
            label: handle
            for axis in axes
            for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)
        }
        entries = (handles.values(), handles.keys())
        legend_outside(figure, "lower center", *entries, ncols=3, frameon=False)


def _draw_steady_sliding(axis: Any, law: FrictionLaw) -> None:
    speed = np.linspace(0.0, LARGEST_SPEED * law.parameters.stribeck_velocity, 400)[1:]
    for direction in (1.0, -1.0):
        force = [steady_friction(direction * v, law) for v in speed]
        axis.plot(direction * speed, force, color=STEADY, lw=2, label="steady speed")


def _draw_rest(axis: Any, law: FrictionLaw) -> None:
    ends = [-breakaway_level(-1.0, law), breakaway_level(1.0, law)]
    axis.plot(
        [0.0, 0.0], ends, "_-", color=REST, lw=2, ms=12, label="at rest, until it breaks away"
    )


def _draw_oscillation(axis: Any, law: FrictionLaw) -> None:
    """F over v in the second period of v = A sin ωt: the bristle lags behind."""
    p, step = law.parameters, 4.0 * np.pi / OSCILLATION / SAMPLES
    amplitude = LARGEST_SPEED * p.stribeck_velocity
    z, force = 0.0, np.empty(SAMPLES)
    speed = amplitude * np.sin(OSCILLATION * step * (np.arange(SAMPLES) + 0.5))
    for k, v in enumerate(speed):
        force[k], z = bristle_force(v, z, step, law)
        force[k] += p.viscous * v
    period = slice(SAMPLES // 2, None)
    axis.plot(
        speed[period],
        force[period],
        color=MOVING,
        lw=1.2,
        label=f"v = {amplitude:.2g} sin({OSCILLATION:.2g} t) rad/s",
    )
