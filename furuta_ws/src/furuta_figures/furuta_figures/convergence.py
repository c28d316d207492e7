"""The transfer function that convergence of the observer rests on, in the plane and over ω."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from furuta_analysis.convergence.convergence import Convergence, ErrorLoop

# Decades of ω shown about the loop's own frequencies, and points of a curve.
DECADES = 1.5
POINTS = 2000
ARM, PASSIVE, VIOLATED = "tab:blue", "tab:green", "tab:red"


def draw(
    g: ErrorLoop, other: ErrorLoop | None, gain: float, verdict: Convergence, path: Path
) -> None:
    """Left ±G(jω), which must keep to the right half plane; right its real part over ω.

    ``other`` is G of an error that satisfies the condition.
    """
    sign = -1.0 if gain < 0.0 else 1.0
    name = "-G" if gain < 0.0 else "G"
    omega = _frequencies(g)
    curves = [(f"{name}, e = φ", ARM, sign * g.at(omega))]
    if other is not None:
        curves.append(("G, e = c·x", PASSIVE, other.at(omega)))
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5.2), layout="constrained")
    _plane(left, curves)
    _real_parts(right, omega, curves, verdict)
    figure.legend(
        *left.get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False
    )
    holds = "satisfied" if verdict.satisfied else "not satisfied"
    figure.suptitle(f"K = {gain:.4g} 1/s: passivity condition {holds} with e = φ")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _frequencies(g: ErrorLoop) -> np.ndarray:
    own = np.abs(np.concatenate([g.poles, g.zeros]))
    own = own[own > 0.0]
    return np.geomspace(np.min(own) / 10**DECADES, np.max(own) * 10**DECADES, POINTS)


def _plane(axis: Any, curves: list[tuple[str, str, np.ndarray]]) -> None:
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
    axis.set_xlabel("Re G")
    axis.set_ylabel("Im G")
    axis.grid(alpha=0.25)


def _real_parts(
    axis: Any, omega: np.ndarray, curves: list[tuple[str, str, np.ndarray]], verdict: Convergence
) -> None:
    for label, colour, values in curves:
        axis.semilogx(omega, values.real, color=colour, lw=1.8, label=label)
    for low, high in verdict.violated_rad_s:
        axis.axvspan(max(low, omega[0]), min(high, omega[-1]), color=VIOLATED, alpha=0.1, lw=0)
    if np.isfinite(verdict.at_omega_rad_s):
        at = max(verdict.at_omega_rad_s, omega[0])
        axis.plot(at, verdict.smallest_real_part, "o", color=ARM, ms=6)
        axis.annotate(
            f"{verdict.smallest_real_part:.3g}\nat ω = {verdict.at_omega_rad_s:.3g} rad/s",
            (at, verdict.smallest_real_part),
            xytext=(8, 16),
            textcoords="offset points",
            bbox={"boxstyle": "round", "fc": "white", "ec": "0.8", "alpha": 0.9},
        )
    axis.axhline(0, color="0.5", lw=0.8)
    axis.set_xlim(omega[0], omega[-1])
    axis.set_xlabel("ω [rad/s]")
    axis.set_ylabel("Re G")
    stable = np.isfinite(verdict.smallest_real_part)
    axis.set_title("shaded: where e = φ violates it" if stable else "G is not stable")
    axis.grid(alpha=0.25)
