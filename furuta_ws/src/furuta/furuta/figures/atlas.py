"""Atlas of hunting: size of the cycle over static friction and integral gain, with its fold."""

from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm

from furuta.axis.folds import Atlas
from furuta.figures.figure import saved_figure, style_axis


def draw_atlas(atlas: Atlas, path: Path) -> None:
    """Draw the peak to peak where the axis hunts, and the curve of folds."""
    with saved_figure(path, figsize=(7.5, 5.0)) as (figure, axis):
        mesh = axis.pcolormesh(
            atlas.ratio, atlas.integral, atlas.peak_to_peak, norm=LogNorm(), shading="nearest"
        )
        known = np.isfinite(atlas.folds)
        axis.plot(atlas.ratio[known], atlas.folds[known], "C3", lw=2, label="fold")
        axis.text(0.04, 0.06, "rest", transform=axis.transAxes)
        style_axis(axis, "static over Coulomb friction", "integral gain [N m/(rad s)]")
        axis.legend(loc="upper left")
        figure.colorbar(mesh, label="error, peak to peak [rad]")
