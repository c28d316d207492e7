"""Figure of a robustness study: the residual over the two parameters that matter most."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm

from furuta.figures.figure import saved_figure
from furuta.figures.labels import axis_label

# More points than this hide each other.
MOST_POINTS = 5000


def draw_robustness(
    names: tuple[str, str], points: np.ndarray, found: np.ndarray, bound: float, path: Path
) -> None:
    """Draw the residuals (n,) [rad] at ``points`` (n, 2); infinite ones are falls."""
    points, found = points[:MOST_POINTS], found[:MOST_POINTS]
    fell = np.isinf(found)
    within = found <= bound
    with saved_figure(path, figsize=(7.5, 6)) as (figure, plane):
        for chosen, marker, label in (
            (within, "o", f"within {bound:.3g} rad"),
            (~within & ~fell, "^", "beyond"),
        ):
            if np.any(chosen):
                dots = plane.scatter(
                    *points[chosen].T,
                    c=found[chosen],
                    s=18,
                    marker=marker,
                    label=label,
                    norm=LogNorm(found[~fell].min(), found[~fell].max()),
                )
        if np.any(fell):
            plane.plot(*points[fell].T, "kx", label="fell")
        if not np.all(fell):
            figure.colorbar(dots, label="arm, peak to peak [rad]")
        plane.set(xlabel=axis_label(names[0]), ylabel=axis_label(names[1]))
        figure.legend(loc="outside lower center", ncols=3)
