"""The transfer function that decides whether the observer converges: G(jω), and Re G over ω."""

from pathlib import Path
from typing import Any

import numpy as np

from furuta.convergence.convergence import Convergence, ObserverPassivity
from furuta.convergence.error_loop import ErrorLoop
from furuta.figures.figure import FAINT_GRID, annotate, saved_figure, style_axis

# Decades of ω shown below and above the loop's frequencies, and points of a curve.
DECADES = 1.5
POINTS = 2000
ARM, PASSIVE, VIOLATED = "tab:blue", "tab:green", "tab:red"


def draw_convergence(passivity: ObserverPassivity, path: Path) -> None:
    """Draw ±G(jω), which must stay in the right half plane, and its real part over ω.

    Beside it G for an error signal that satisfies the condition.
    """
    g, gain, verdict = passivity.loop, passivity.gain, passivity.convergence
    sign, name = (-1.0, "-G") if gain < 0.0 else (1.0, "G")
    omega = _frequencies(g)
    curves = [(f"{name}, e = φ", ARM, sign * g.at(omega))]
    if passivity.with_error is not None:
        curves.append(("G, e = c·x", PASSIVE, passivity.with_error.at(omega)))
    with saved_figure(path, 1, 2, figsize=(12, 5.2)) as (figure, (left, right)):
        _draw_plane(left, curves)
        _draw_real_parts(right, omega, curves, verdict)
        figure.legend(
            *left.get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False
        )
        holds = "satisfied" if verdict.satisfied else "not satisfied"
        figure.suptitle(f"K = {gain:.4g} 1/s: passivity condition {holds} with e = φ")


def _frequencies(g: ErrorLoop) -> np.ndarray:
    corners = np.abs(np.concatenate([g.poles, g.zeros]))
    corners = corners[corners > 0.0]
    return np.geomspace(np.min(corners) / 10**DECADES, np.max(corners) * 10**DECADES, POINTS)


def _draw_plane(axis: Any, curves: list[tuple[str, str, np.ndarray]]) -> None:
    for label, colour, values in curves:
        axis.plot(values.real, values.imag, color=colour, lw=1.8, label=label)
        axis.plot(values.real, -values.imag, color=colour, lw=1, ls=":")
        axis.plot(values.real[0], values.imag[0], "o", color=colour, mfc="white", ms=7)
    axis.plot([], [], "o", color="0.3", mfc="white", ms=7, label="ω → 0")
    axis.plot([], [], ":", color="0.3", lw=1, label="ω < 0")
    low, _ = axis.get_xlim()
    axis.axvspan(low, 0.0, color=VIOLATED, alpha=0.1, lw=0, label="forbidden: Re < 0")
    axis.set_xlim(left=low)
    axis.axhline(0, color="0.75", lw=0.8, zorder=0)
    style_axis(axis, "Re G", "Im G", FAINT_GRID)


def _draw_real_parts(
    axis: Any, omega: np.ndarray, curves: list[tuple[str, str, np.ndarray]], verdict: Convergence
) -> None:
    for label, colour, values in curves:
        axis.semilogx(omega, values.real, color=colour, lw=1.8, label=label)
    for low, high in verdict.violated_rad_s:
        axis.axvspan(max(low, omega[0]), min(high, omega[-1]), color=VIOLATED, alpha=0.1, lw=0)
    if np.isfinite(verdict.at_omega_rad_s):
        at = max(verdict.at_omega_rad_s, omega[0])
        axis.plot(at, verdict.smallest_real_part, "o", color=ARM, ms=6)
        text = f"{verdict.smallest_real_part:.3g}\nat ω = {verdict.at_omega_rad_s:.3g} rad/s"
        annotate(axis, (at, verdict.smallest_real_part), text, xytext=(8, 16))
    axis.axhline(0, color="0.5", lw=0.8)
    axis.set_xlim(omega[0], omega[-1])
    style_axis(axis, "ω [rad/s]", "Re G", FAINT_GRID)
    stable = np.isfinite(verdict.smallest_real_part)
    axis.set_title("shaded: where e = φ violates it" if stable else "G is not stable")
