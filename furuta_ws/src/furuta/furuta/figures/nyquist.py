"""Nyquist plots like Fig. 4 of the paper, with −1/N of Coulomb friction and the crossings.

``control.nyquist_plot`` goes round a pole at 0 that G does not have (:mod:`furuta.transfer`).
"""

from pathlib import Path
from typing import Any

import numpy as np

from furuta.figures.figure import FAINT_GRID, annotate, legend_outside, saved_figure, style_axis
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.transfer import Transfer, transfer

# Decades of ω shown below and above the loop's frequencies, and points of the curve.
DECADES = 4.0
POINTS = 20_000
# Extent of the axes over the farthest crossing, or the largest real part.
EXTENT = 2.2
LINE, NEGATIVE_AXIS, MARK = "tab:blue", "tab:red", "black"


def draw_nyquist(cases: dict[str, IdealLoop], path: Path) -> None:
    """Draw one panel per case by letter; a single one has no letter."""
    rows, columns = (1, 1) if len(cases) == 1 else (2, -(-len(cases) // 2))
    size = (7 if columns == 1 else 5.6 * columns, 5.2 * rows)
    with saved_figure(path, rows, columns, figsize=size, squeeze=False) as (figure, axes):
        for axis, (case, loop) in zip(axes.flat, cases.items(), strict=False):
            _draw_panel(axis, transfer(loop.body, loop.gains))
            letter = case if len(cases) > 1 else ""
            axis.set_title(feedback_title(letter, loop.gains))
        entries = axes[0, 0].get_legend_handles_labels()
        legend_outside(figure, "lower center", *entries, ncols=4, frameon=False)


def feedback_title(case: str, feedback: tuple[float, float, float, float]) -> str:
    """The feedback as the paper writes it."""
    terms = ("φ", "φ̇", "θ", "θ̇")
    order = (2, 3, 0, 1)
    parts = [f"{feedback[i]:+.3g} {terms[i]}" for i in order if feedback[i] != 0.0]
    text = " ".join(parts).lstrip("+") or "0"
    return f"{case}) u = {text}" if case else f"u = {text}"


def nyquist_curve(g: Transfer) -> tuple[np.ndarray, np.ndarray]:
    """ω [rad/s] and G(jω) on a fine grid over all visible frequencies."""
    corners = np.abs(g.poles[np.abs(g.poles) > 0.0])
    low, high = np.min(corners) / 10**DECADES, np.max(corners) * 10 ** (DECADES / 2)
    omega = np.geomspace(low, high, POINTS)
    return omega, g.at(omega)


def _draw_panel(axis: Any, g: Transfer) -> None:
    _, values = nyquist_curve(g)
    low, high, height = _limits(g, values)
    axis.axhline(0, color="0.75", lw=0.8, zorder=0)
    axis.axvline(0, color="0.75", lw=0.8, zorder=0)
    axis.plot(
        [low, 0], [0, 0], color=NEGATIVE_AXIS, lw=4, alpha=0.35, label="-1/N(A), Coulomb", zorder=1
    )
    axis.plot(values.real, values.imag, color=LINE, lw=1.6, label="G(jω), ω > 0", zorder=2)
    axis.plot(values.real, -values.imag, color=LINE, lw=1, ls=":", label="ω < 0", zorder=2)
    axis.set_xlim(low, high)
    axis.set_ylim(-height, height)
    for crossing in g.crossings:
        _mark_crossing(axis, crossing.omega_rad_s, crossing.real)
    # Empty curve, so that the legend of the first panel has this entry even without a crossing.
    axis.plot([], [], "o", color=MARK, ms=7, mfc="white", label="crossing")
    style_axis(axis, "Re G [rad/(s V)]", "Im G [rad/(s V)]", FAINT_GRID)


def _limits(g: Transfer, values: np.ndarray) -> tuple[float, float, float]:
    """Left, right and half height [rad/(s V)] at which crossings and curve are visible.

    The real part is bounded even if G has an integrator. It sets the scale unless it is 0.
    """
    scale = max(float(np.max(np.abs(values.real))), float(np.median(np.abs(values))))
    shown = values[np.abs(values) < EXTENT * scale]
    left = min([float(np.min(shown.real)), *(EXTENT * crossing.real for crossing in g.crossings)])
    left = left if g.crossings else -scale
    right = max(float(np.max(shown.real)), -0.25 * left)
    return 1.1 * left, 1.1 * right, 1.1 * float(np.max(np.abs(shown.imag)))


def _mark_crossing(axis: Any, omega: float, real: float) -> None:
    axis.plot(real, 0, "o", color=MARK, ms=7, mfc="white", mew=1.5, zorder=4)
    where = f"ω = {omega:.3g} rad/s" if omega > 0.0 else "ω = 0: rotation"
    annotate(axis, (real, 0), f"{where}\nG = {real:.3g}", xytext=(0, -12), ha="center", va="top")
