"""Recordings beside what a model says of them, and what is left."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from furuta_identification.quality import Followed
from furuta_identification.record import CHANNELS, UNITS


def draw_residuals(followed: list[Followed], path: Path) -> None:
    """A column a recording; each channel measured and modelled, its residual below."""
    channels = [
        k
        for k in range(len(CHANNELS))
        if any(np.any(np.isfinite(each.recording.measured[:, k])) for each in followed)
    ]
    figure, axes = plt.subplots(
        2 * len(channels),
        len(followed),
        sharex="col",
        squeeze=False,
        figsize=(6.5 * len(followed), 2.6 * len(channels)),
        height_ratios=[2, 1] * len(channels),
        layout="constrained",
    )
    for column, each in zip(axes.T, followed, strict=True):
        column[0].set_title(each.recording.name)
        time = each.recording.time
        for row, k in enumerate(channels):
            measured, predicted = each.recording.measured[:, k], each.predicted[:, k]
            upper, lower = column[2 * row], column[2 * row + 1]
            upper.plot(time, measured, lw=1.4, label="measured")
            upper.plot(time, predicted, lw=0.9, label="model")
            lower.plot(time, measured - predicted, lw=0.7, color="C3")
            upper.set_ylabel(f"{CHANNELS[k]} [{UNITS[k]}]")
            lower.set_ylabel("residual")
            for axis in (upper, lower):
                axis.grid(alpha=0.3)
                axis.margins(x=0)
        column[-1].set_xlabel("time [s]")
    axes[0, 0].legend(loc="best")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)
    plt.close(figure)
