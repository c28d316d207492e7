"""G(jω) beside −1/N of every law, and N itself over the amplitude."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from furuta_analysis.describing_functions.describing_function import describing_function
from furuta_analysis.describing_functions.predicted_cycles import Prediction
from furuta_analysis.describing_functions.transfer import Transfer, transfer
from furuta_analysis.limit_cycles.ideal_loop import IdealLoop
from furuta_figures.nyquist import curve, title
from furuta_model.friction.laws import LAWS, FrictionLaw

# Amplitudes drawn about the predicted one, points per curve, axes' extent over |G| there.
SPAN = 300.0
POINTS = 200
ZOOM = 2.0
PALETTE = ("tab:red", "tab:orange", "tab:purple", "tab:green", "tab:brown", "tab:cyan")
COLOURS = {name: PALETTE[k % len(PALETTE)] for k, name in enumerate(LAWS)}


def draw(given: IdealLoop, prediction: Prediction, path: Path) -> None:
    """Left the curves that must meet, right |N| and the angle of N, at the predicted ω."""
    g = transfer(given.body, given.gains)
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5.2), layout="constrained")
    omega, amplitude = _centre(g, given.law, prediction)
    _plane(left, g, given.law, prediction, omega, amplitude)
    _functions(right, given.law, omega, amplitude)
    figure.suptitle(title("", given.gains))
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _centre(g: Transfer, law: FrictionLaw, prediction: Prediction) -> tuple[float, float]:
    """ω and A [rad/s] to draw about: the largest cycle's, or the loop's own scale."""
    if prediction.cycles:
        cycle = prediction.cycles[-1]
        return cycle.omega_rad_s, cycle.velocity_amplitude_rad_s
    omega = float(np.median(np.abs(g.poles)))
    return omega, 4.0 / np.pi * max(law.parameters.alpha0, 1e-3) * abs(complex(g.at(omega)))


def _inverse(law: FrictionLaw, amplitudes: np.ndarray, omega: float) -> np.ndarray:
    n = np.array([describing_function(a, omega, law) for a in amplitudes])
    return -1.0 / n[n != 0.0]


def _plane(
    axis: Any, g: Transfer, law: FrictionLaw, prediction: Prediction, omega: float, amplitude: float
) -> None:
    _, values = curve(g)
    axis.plot(values.real, values.imag, color="tab:blue", lw=1.8, label="G(jω)")
    amplitudes = np.geomspace(amplitude / SPAN, amplitude * SPAN, 4 * POINTS)
    for drawn in (law, law.named("coulomb" if law.bristle else "lugre")):
        inverse = _inverse(drawn, amplitudes, omega)
        label = f"-1/N, {drawn.name}" + (f", ω = {omega:.3g} rad/s" if drawn.bristle else "")
        axis.plot(inverse.real, inverse.imag, color=COLOURS[drawn.name], lw=1.8, label=label)
    for cycle in prediction.cycles:
        point = complex(g.at(cycle.omega_rad_s))
        axis.plot(point.real, point.imag, "o", mfc="white", mec="black", ms=8, zorder=5)
        axis.annotate(
            f"A = {cycle.velocity_amplitude_rad_s:.3g} rad/s\nω = {cycle.omega_rad_s:.3g} rad/s",
            (point.real, point.imag),
            xytext=(12, -14),
            textcoords="offset points",
            va="top",
            bbox={"boxstyle": "round", "fc": "white", "ec": "0.8"},
        )
    extent = ZOOM * abs(complex(g.at(omega)))
    axis.set_xlim(-extent, 0.5 * extent)
    axis.set_ylim(-0.75 * extent, 0.75 * extent)
    axis.set_xlabel("Re [rad/(s V)]")
    axis.set_ylabel("Im [rad/(s V)]")
    axis.set_title("limit cycles where the curves meet")
    axis.grid(alpha=0.25)
    axis.legend(loc="lower right")


def _functions(axis: Any, law: FrictionLaw, omega: float, amplitude: float) -> None:
    amplitudes = np.geomspace(amplitude / SPAN, amplitude * SPAN / 30, POINTS)
    phase = axis.twinx()
    for kind, name in enumerate(LAWS):
        drawn = FrictionLaw(kind, law.parameters)
        n = np.array([describing_function(a, omega, drawn) for a in amplitudes])
        style = "--" if name == "stiction" else "-"  # lies on Coulomb's
        axis.loglog(amplitudes, np.abs(n), style, color=COLOURS[name], lw=1.8, label=name)
        phase.semilogx(amplitudes, np.degrees(np.angle(n)), ":", color=COLOURS[name], lw=1.2)
    axis.axvline(amplitude, color="0.6", lw=0.8)
    axis.set_xlabel("amplitude A of the arm's speed [rad/s]")
    axis.set_ylabel("|N| [V s/rad] (lines)")
    phase.set_ylabel("angle of N [°] (dotted)")
    phase.set_ylim(-100, 10)
    axis.set_title(f"describing functions at ω = {omega:.3g} rad/s")
    axis.grid(alpha=0.25)
    axis.legend(loc="lower left")
