"""Recordings, the model's prediction of them, and the residuals."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from furuta.figures.figure import (
    ARM,
    MEASURED,
    PENDULUM,
    axes_for,
    numbered_axes,
    style_time_series,
)
from furuta.figures.friction import draw_law
from furuta.identification.model import Prediction
from furuta.identification.result.friction_curve import FrictionCurve
from furuta_recordings.recording import CHANNELS, UNITS

# Colours of the channels.
COLOURS = (ARM, ARM, PENDULUM, PENDULUM)


def draw_rig_model(
    curve: FrictionCurve,
    followed: Sequence[Prediction],
    others: Sequence[Prediction],
    axes: Any = None,
) -> Any:
    """Draw the friction over speed, below it the recordings as :func:`draw_residuals` does."""
    runs = [*followed, *others]
    rows = 2 * len(_measured_channels(runs))
    grid = 1 + np.arange(rows * len(runs)).reshape(rows, len(runs))
    layout = [[0] * len(runs), *grid.tolist()]
    size = (max(7.0 * len(runs), 9.0), 4.0 + 1.3 * rows)
    heights = [3.5] + [2, 1] * (rows // 2)
    drawn = numbered_axes(axes, layout, figsize=size, height_ratios=heights)
    draw_law(drawn[0], curve)
    draw_residuals(followed, others, drawn[1:])
    return np.array(drawn)


def draw_residuals(
    followed: Sequence[Prediction], others: Sequence[Prediction], axes: Any = None
) -> Any:
    """Draw one column per recording (``others`` were held out), each channel above its residual."""
    runs = [*followed, *others]
    channels = _measured_channels(runs)
    size = (7.0 * len(runs), 2.6 * len(channels))
    grid = {"squeeze": False, "height_ratios": [2, 1] * len(channels)}
    figure, axes = axes_for(axes, 2 * len(channels), len(runs), figsize=size, **grid)
    for number, (column, run) in enumerate(zip(axes.T, runs, strict=True)):
        held_out = " (held out)" if number >= len(followed) else ""
        column[0].set_title(run.recording.name + held_out, loc="left")
        for axis in column[1:]:
            axis.sharex(column[0])
        for axis in column[:-1]:
            axis.tick_params(labelbottom=False)
        fits = run.fits()
        for row, k in enumerate(channels):
            _draw_channel(column[2 * row], column[2 * row + 1], run, k, fits[CHANNELS[k]])
        column[-1].set_xlabel("time [s]")
    place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0)}
    axes[0, 0].legend(**place, ncols=2, frameon=False)
    figure.align_ylabels()
    return axes


def _measured_channels(runs: Sequence[Prediction]) -> list[int]:
    """Channels that at least one recording holds."""
    return [
        k
        for k in range(len(CHANNELS))
        if any(np.any(np.isfinite(run.recording.measured[:, k])) for run in runs)
    ]


def _draw_channel(upper: Axes, lower: Axes, run: Prediction, k: int, fit: float) -> None:
    """Draw one channel, measured and modelled, and the difference."""
    time, measured = run.recording.time, run.recording.measured[:, k]
    upper.plot(time, measured, lw=2.2, color=MEASURED, label="measured")
    upper.plot(time, run.predicted[:, k], lw=0.9, color=COLOURS[k], label="model")
    if np.isfinite(fit):
        upper.set_title(f"fit {fit:.1f} %", loc="right", fontsize="medium")
    lower.plot(time, measured - run.predicted[:, k], lw=0.7, color=COLOURS[k])
    style_time_series(upper, f"{CHANNELS[k]}\n[{UNITS[k]}]")
    style_time_series(lower, f"residual\n[{UNITS[k]}]")
