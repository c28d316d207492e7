"""Describing functions: G(jω) beside −1/N, and N of every law over the amplitude."""

from pathlib import Path
from typing import Any

import numpy as np

from furuta.describing_functions.describing_function import describing_function
from furuta.describing_functions.predicted_cycles import Prediction
from furuta.figures.figure import FAINT_GRID, annotate, saved_figure, style_axis
from furuta.figures.nyquist import feedback_title, nyquist_curve
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.transfer import Transfer, transfer
from furuta_model.friction.laws import ANALYSED_LAWS, FrictionLaw

# Amplitudes are drawn from 1/SPAN to SPAN of the predicted one. ZOOM is the extent of the axes over
# |G| at the predicted frequency.
SPAN = 300.0
POINTS = 200
ZOOM = 2.0
PALETTE = ("tab:red", "tab:orange", "tab:purple", "tab:green", "tab:brown", "tab:cyan")
COLOURS = {name: PALETTE[k % len(PALETTE)] for k, name in enumerate(ANALYSED_LAWS)}


def draw_describing_function(loop: IdealLoop, prediction: Prediction, path: Path) -> None:
    """Draw G and −1/N, which meet at a limit cycle, and N at the predicted ω."""
    g = transfer(loop.body, loop.gains)
    omega, amplitude = _centre(g, loop.law, prediction)
    with saved_figure(path, 1, 2, figsize=(12, 5.2)) as (figure, (left, right)):
        _draw_plane(left, g, loop.law, prediction, omega, amplitude)
        _draw_functions(right, loop.law, omega, amplitude)
        figure.suptitle(feedback_title("", loop.gains))


def _centre(g: Transfer, law: FrictionLaw, prediction: Prediction) -> tuple[float, float]:
    """ω and A [rad/s] at the middle of the figure: the largest cycle's, or the loop's scale."""
    if prediction.cycles:
        cycle = prediction.cycles[-1]
        return cycle.omega_rad_s, cycle.velocity_amplitude_rad_s
    omega = float(np.median(np.abs(g.poles)))
    return omega, 4.0 / np.pi * max(law.parameters.alpha0, 1e-3) * abs(complex(g.at(omega)))


def _inverse(law: FrictionLaw, amplitudes: np.ndarray, omega: float) -> np.ndarray:
    n = np.array([describing_function(a, omega, law) for a in amplitudes])
    return -1.0 / n[n != 0.0]


def _draw_plane(
    axis: Any, g: Transfer, law: FrictionLaw, prediction: Prediction, omega: float, amplitude: float
) -> None:
    _, values = nyquist_curve(g)
    axis.plot(values.real, values.imag, color="tab:blue", lw=1.8, label="G(jω)")
    amplitudes = np.geomspace(amplitude / SPAN, amplitude * SPAN, 4 * POINTS)
    for drawn in (law, law.named("coulomb" if law.bristle else "lugre")):
        inverse = _inverse(drawn, amplitudes, omega)
        label = f"-1/N, {drawn.name}" + (f", ω = {omega:.3g} rad/s" if drawn.bristle else "")
        axis.plot(inverse.real, inverse.imag, color=COLOURS[drawn.name], lw=1.8, label=label)
    for cycle in prediction.cycles:
        point = complex(g.at(cycle.omega_rad_s))
        axis.plot(point.real, point.imag, "o", mfc="white", mec="black", ms=8, zorder=5)
        text = f"A = {cycle.velocity_amplitude_rad_s:.3g} rad/s\nω = {cycle.omega_rad_s:.3g} rad/s"
        annotate(axis, (point.real, point.imag), text, xytext=(12, -14), va="top")
    extent = ZOOM * abs(complex(g.at(omega)))
    axis.set_xlim(-extent, 0.5 * extent)
    axis.set_ylim(-0.75 * extent, 0.75 * extent)
    style_axis(axis, "Re [rad/(s V)]", "Im [rad/(s V)]", FAINT_GRID)
    axis.set_title("limit cycles where the curves meet")
    axis.legend(loc="lower right")


def _draw_functions(axis: Any, law: FrictionLaw, omega: float, amplitude: float) -> None:
    amplitudes = np.geomspace(amplitude / SPAN, amplitude * SPAN / 30, POINTS)
    phase = axis.twinx()
    for name in ANALYSED_LAWS:
        n = np.array([describing_function(a, omega, law.named(name)) for a in amplitudes])
        style = "--" if name == "stiction" else "-"  # it covers Coulomb's curve
        axis.loglog(amplitudes, np.abs(n), style, color=COLOURS[name], lw=1.8, label=name)
        phase.semilogx(amplitudes, np.degrees(np.angle(n)), ":", color=COLOURS[name], lw=1.2)
    axis.axvline(amplitude, color="0.6", lw=0.8)
    style_axis(axis, "amplitude A of the arm's speed [rad/s]", "|N| [V s/rad] (lines)", FAINT_GRID)
    phase.set_ylabel("angle of N [°] (dotted)")
    phase.set_ylim(-100, 10)
    axis.set_title(f"describing functions at ω = {omega:.3g} rad/s")
    axis.legend(loc="lower left")
