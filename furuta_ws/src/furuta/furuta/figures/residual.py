"""Recordings, the model's prediction of them, and the residuals."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from furuta.figures.figure import axes_for, legend_outside, style_time_series
from furuta.identification.model import Prediction
from furuta_recordings.recording import CHANNELS, UNITS


def draw_residuals(followed: list[Prediction], others: list[Prediction], axes: Any = None) -> Any:
    """Draw one column per recording (``others`` were held out), each channel above its residual."""
    runs = [*followed, *others]
    channels = _measured_channels(runs)
    size = (7.0 * len(runs), 2.6 * len(channels))
    grid = {"sharex": "col", "squeeze": False, "height_ratios": [2, 1] * len(channels)}
    figure, axes = axes_for(axes, 2 * len(channels), len(runs), figsize=size, **grid)
    for number, (column, run) in enumerate(zip(axes.T, runs, strict=True)):
        held_out = " (held out)" if number >= len(followed) else ""
        column[0].set_title(run.recording.name + held_out, loc="left")
        fits = run.fits()
        for row, k in enumerate(channels):
            _draw_channel(column[2 * row], column[2 * row + 1], run, k, fits[CHANNELS[k]])
        column[-1].set_xlabel("time [s]")
    entries = axes[0, 0].get_legend_handles_labels()
    legend_outside(figure, "upper right", *entries, ncols=2)
    figure.align_ylabels()
    return axes


def _measured_channels(runs: list[Prediction]) -> list[int]:
    """Channels that at least one recording holds."""
    return [
        k
        for k in range(len(CHANNELS))
        if any(np.any(np.isfinite(run.recording.measured[:, k])) for run in runs)
    ]


def _draw_channel(upper: Axes, lower: Axes, run: Prediction, k: int, fit: float) -> None:
    """Draw one channel, measured and modelled, and the difference."""
    time, measured = run.recording.time, run.recording.measured[:, k]
    upper.plot(time, measured, lw=1.6, label="measured")
    upper.plot(time, run.predicted[:, k], lw=0.9, label="model")
    if np.isfinite(fit):
        upper.set_title(f"fit {fit:.1f} %", loc="right", fontsize="medium")
    lower.plot(time, measured - run.predicted[:, k], lw=0.7, color="C3")
    style_time_series(upper, f"{CHANNELS[k]}\n[{UNITS[k]}]")
    style_time_series(lower, f"residual\n[{UNITS[k]}]")
