"""The limit cycle that remains with compensation over the sensor noise, for both estimators."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from furuta.figures.figure import saved_figure
from furuta.studies.sensitivity import METHODS, SensitivityRow

TITLES = {"kalman": "Kalman filter", "lowpass": "the paper's low-pass"}


def draw_sensitivity(rows: Sequence[SensitivityRow], encoder_count: float, path: Path) -> None:
    """Draw one panel per estimator, one line per compensation, a band over the seeds."""
    shared: dict[str, Any] = {"sharex": True, "sharey": True, "figsize": (11, 4.6)}
    names = list(dict.fromkeys(row.compensation for row in rows))
    with saved_figure(path, 1, len(METHODS), **shared) as (figure, axes):
        for axis, method in zip(axes, METHODS, strict=True):
            for number, name in enumerate(names):
                line = [row for row in rows if (row.method, row.compensation) == (method, name)]
                if not line:
                    continue
                colour, noise = f"C{number}", [row.noise for row in line]
                axis.plot(noise, [row.mean for row in line], "o-", ms=3, color=colour, label=name)
                low, high = [row.smallest for row in line], [row.largest for row in line]
                axis.fill_between(noise, low, high, color=colour, alpha=0.2)
            axis.axhline(encoder_count, color="0.4", lw=0.8, ls="--", label="one encoder count")
            axis.set_title(TITLES[method])
            axis.set_xscale("log", base=2)
            axis.set_yscale("log")
            axis.set_xlabel("noise [codes of the converters]")
            axis.grid(alpha=0.3, which="both")
        axes[0].set_ylabel("arm, peak to peak [rad]")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=6)
