"""Nyquist plots in the manner of Fig. 4, with −1/N of Coulomb friction and the crossings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from furuta_analysis.describing_functions.transfer import Transfer, transfer
from furuta_analysis.limit_cycles.ideal_loop import IdealLoop

# Decades of ω shown below and above the loop's own frequencies, and points of the curve.
DECADES = 4.0
POINTS = 20_000
# Axes end at this many times the farthest crossing, or the largest real part.
ROOM = 2.2
LINE, NEGATIVE_AXIS, MARK = "tab:blue", "tab:red", "black"


def draw(cases: dict[str, IdealLoop], path: Path) -> None:
    """One panel per case; ``cases`` by their letters, or one without."""
    rows, columns = (1, 1) if len(cases) == 1 else (2, -(-len(cases) // 2))
    figure, axes = plt.subplots(
        rows,
        columns,
        figsize=(7 if columns == 1 else 5.6 * columns, 5.2 * rows),
        layout="constrained",
        squeeze=False,
    )
    for axis, (case, each) in zip(axes.flat, cases.items(), strict=False):
        g = transfer(each.body, each.gains)
        _panel(axis, g)
        axis.set_title(title(case, each.gains))
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def title(case: str, feedback: tuple[float, float, float, float]) -> str:
    """The feedback as the paper writes it."""
    terms = ("φ", "φ̇", "θ", "θ̇")
    order = (2, 3, 0, 1)
    parts = [f"{feedback[i]:+.3g} {terms[i]}" for i in order if feedback[i] != 0.0]
    text = " ".join(parts).lstrip("+") or "0"
    return f"{case}) u = {text}" if case else f"u = {text}"


def curve(g: Transfer) -> tuple[np.ndarray, np.ndarray]:
    """ω [rad/s] and G(jω), dense, over all frequencies that show."""
    own = np.abs(g.poles[np.abs(g.poles) > 0.0])
    omega = np.geomspace(np.min(own) / 10**DECADES, np.max(own) * 10 ** (DECADES / 2), POINTS)
    return omega, g.at(omega)


def _panel(axis: Any, g: Transfer) -> None:
    _, values = curve(g)
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
    _arrow(axis, values, (high - low, 2 * height))
    for crossing in g.crossings:
        _mark(axis, crossing.omega_rad_s, crossing.real)
    # Empty, so that the legend of the first panel names both marks.
    axis.plot([], [], "o", color=MARK, ms=7, mfc="white", label="crossing")
    axis.set_xlabel("Re G [rad/(s V)]")
    axis.set_ylabel("Im G [rad/(s V)]")
    axis.grid(alpha=0.25)


def _limits(g: Transfer, values: np.ndarray) -> tuple[float, float, float]:
    """Left, right and half height [rad/(s V)] that show the crossings and the curve's shape.

    The real part is bounded even where G has an integrator: it gives the scale, unless it is 0.
    """
    scale = max(float(np.max(np.abs(values.real))), float(np.median(np.abs(values))))
    shown = values[np.abs(values) < ROOM * scale]
    left = min([float(np.min(shown.real)), *(ROOM * each.real for each in g.crossings)])
    left = left if g.crossings else -scale
    right = max(float(np.max(shown.real)), -0.25 * left)
    return 1.1 * left, 1.1 * right, 1.1 * float(np.max(np.abs(shown.imag)))


def _arrow(axis: Any, values: np.ndarray, size: tuple[float, float]) -> None:
    """The sense of rising ω, where the visible curve has come half its way."""
    scaled = values.real / size[0] + 1j * values.imag / size[1]
    visible = np.abs(values.imag[1:]) < 0.5 * size[1]
    way = np.cumsum(np.where(visible, np.abs(np.diff(scaled)), 0.0))
    tail, head = (values[np.searchsorted(way, part * way[-1])] for part in (0.5, 0.51))
    axis.annotate(
        "",
        (head.real, head.imag),
        (tail.real, tail.imag),
        arrowprops={"arrowstyle": "-|>", "color": LINE, "mutation_scale": 18},
    )


def _mark(axis: Any, omega: float, real: float) -> None:
    axis.plot(real, 0, "o", color=MARK, ms=7, mfc="white", mew=1.5, zorder=4)
    text = f"ω = {omega:.3g} rad/s" if omega > 0.0 else "ω = 0: rotation"
    axis.annotate(
        f"{text}\nG = {real:.3g}",
        (real, 0),
        xytext=(0, -12),
        textcoords="offset points",
        ha="center",
        va="top",
        bbox={"boxstyle": "round", "fc": "white", "ec": "0.8", "alpha": 0.9},
        zorder=5,
    )
