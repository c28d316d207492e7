"""Nyquist plots like Fig. 4 of the paper, and describing functions over the amplitude.

``control.nyquist_plot`` goes round a pole at 0 that G does not have (:mod:`furuta.transfer`).
"""

from typing import Any

import numpy as np

from furuta.describing_functions.describing_function import describing_function
from furuta.describing_functions.predicted_cycles import Prediction
from furuta.figures.figure import FAINT_GRID, annotate, axes_for, legend_outside, style_axis
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.transfer import Transfer, transfer
from furuta_model.friction.laws import ANALYSED_LAWS, FrictionLaw

# Decades of ω shown below and above the loop's frequencies, and points of the curve.
DECADES = 4.0
POINTS = 20_000
# Extent of the axes over the farthest crossing, or the largest real part.
EXTENT = 2.2
# Amplitudes are drawn from 1/SPAN to SPAN of the predicted one. ZOOM is the extent of the axes over
# |G| at the predicted frequency.
SPAN = 300.0
AMPLITUDES = 200
ZOOM = 2.0
PALETTE = ("tab:red", "tab:orange", "tab:purple", "tab:green", "tab:brown", "tab:cyan")
COLOURS = {name: PALETTE[k % len(PALETTE)] for k, name in enumerate(ANALYSED_LAWS)}
LINE, NEGATIVE_AXIS, MARK = "tab:blue", "tab:red", "black"


def draw_nyquist(cases: dict[str, IdealLoop], axes: Any = None) -> Any:
    """Draw one panel per case by letter; a single one has no letter."""
    rows, columns = (1, 1) if len(cases) == 1 else (2, -(-len(cases) // 2))
    size = (7 if columns == 1 else 5.6 * columns, 5.2 * rows)
    figure, axes = axes_for(axes, rows, columns, figsize=size, squeeze=False)
    for axis, (case, loop) in zip(axes.flat, cases.items(), strict=False):
        _draw_panel(axis, transfer(loop.body, loop.gains))
        letter = case if len(cases) > 1 else ""
        axis.set_title(feedback_title(letter, loop.gains))
    entries = axes[0, 0].get_legend_handles_labels()
    legend_outside(figure, "lower center", *entries, ncols=4, frameon=False)
    return axes


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


def draw_describing_function(loop: IdealLoop, prediction: Prediction, axes: Any = None) -> Any:
    """Draw G and −1/N, which meet at a limit cycle, and N at the predicted ω."""
    g = transfer(loop.body, loop.gains)
    omega, amplitude = _centre(g, loop.law, prediction)
    figure, axes = axes_for(axes, 1, 2, figsize=(12, 5.2))
    left, right = axes
    _draw_plane(left, g, loop.law, prediction, omega, amplitude)
    _draw_functions(right, loop.law, omega, amplitude)
    figure.suptitle(feedback_title("", loop.gains))
    return axes


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
    axis.plot(values.real, values.imag, color=LINE, lw=1.8, label="G(jω)")
    amplitudes = np.geomspace(amplitude / SPAN, amplitude * SPAN, 4 * AMPLITUDES)
    for drawn in _compared(law):
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


def _compared(law: FrictionLaw) -> tuple[FrictionLaw, FrictionLaw]:
    """The law, and one with a bristle if it has none, or the other way round."""
    return law, law.named("coulomb" if law.bristle else "lugre")


def _draw_functions(axis: Any, law: FrictionLaw, omega: float, amplitude: float) -> None:
    amplitudes = np.geomspace(amplitude / SPAN, amplitude * SPAN / 30, AMPLITUDES)
    phase = axis.twinx()
    for drawn in _compared(law):
        n = np.array([describing_function(a, omega, drawn) for a in amplitudes])
        colour = COLOURS[drawn.name]
        axis.loglog(amplitudes, np.abs(n), color=colour, lw=1.8, label=drawn.name)
        phase.semilogx(amplitudes, np.degrees(np.angle(n)), ":", color=colour, lw=1.2)
    axis.axvline(amplitude, color="0.6", lw=0.8)
    style_axis(axis, "amplitude A of the arm's speed [rad/s]", "|N| [V s/rad] (lines)", FAINT_GRID)
    phase.set_ylabel("angle of N [°] (dotted)")
    phase.set_ylim(-100, 10)
    axis.set_title(f"describing functions at ω = {omega:.3g} rad/s")
    axis.legend(loc="lower left")
