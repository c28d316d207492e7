"""Recordings beside what a model says of them, and what is left."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from furuta_identification.fitting.validation import Prediction
from furuta_recordings.recording import CHANNELS, UNITS


def draw_residuals(followed: list[Prediction], others: list[Prediction], path: Path) -> None:
    """A column a recording, ``others`` held out; each channel and, below it, what is left."""
    each_of = [*followed, *others]
    channels = [
        k
        for k in range(len(CHANNELS))
        if any(np.any(np.isfinite(each.recording.measured[:, k])) for each in each_of)
    ]
    figure, axes = plt.subplots(
        2 * len(channels),
        len(each_of),
        sharex="col",
        squeeze=False,
        figsize=(7.0 * len(each_of), 2.6 * len(channels)),
        height_ratios=[2, 1] * len(channels),
        layout="constrained",
    )
    for place, (column, each) in enumerate(zip(axes.T, each_of, strict=True)):
        held_out = " (held out)" if place >= len(followed) else ""
        column[0].set_title(each.recording.name + held_out, loc="left")
        fits = each.fits()
        for row, k in enumerate(channels):
            _draw_channel(column[2 * row], column[2 * row + 1], each, k, fits[CHANNELS[k]])
        column[-1].set_xlabel("time [s]")
    lines, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(lines, labels, loc="outside upper right", ncols=2)
    figure.align_ylabels()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def _draw_channel(upper: Axes, lower: Axes, each: Prediction, k: int, fit: float) -> None:
    """One channel, measured and modelled, and the difference."""
    time, measured = each.recording.time, each.recording.measured[:, k]
    upper.plot(time, measured, lw=1.6, label="measured")
    upper.plot(time, each.predicted[:, k], lw=0.9, label="model")
    if np.isfinite(fit):
        upper.set_title(f"fit {fit:.1f} %", loc="right", fontsize="medium")
    upper.set_ylabel(f"{CHANNELS[k]}\n[{UNITS[k]}]")
    lower.plot(time, measured - each.predicted[:, k], lw=0.7, color="C3")
    lower.set_ylabel(f"residual\n[{UNITS[k]}]")
    for axis in (upper, lower):
        axis.grid(alpha=0.3)
        axis.margins(x=0)
