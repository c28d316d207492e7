r"""Stability margins of the sliding loop at the input of the plant.

The loop is that of the linear pendulum with u = −Lx and no friction, cut at u:

.. math:: L(jω) = \frac{p_c(jω) - p_o(jω)}{p_o(jω)}, \qquad S(jω) = \frac{p_o(jω)}{p_c(jω)}

with the characteristic polynomials :math:`p_o` of the pendulum and :math:`p_c` of the loop. These
are the margins of a loop whose friction is compensated exactly, at any amplitude. Without
compensation friction is one more damper on the sliding arm, and the loop bears more than they say.
They do not cover the estimator, the sample time, the drive's range, a compensator with another
friction than the true one, nor sticking.

The disk margin α allows gain and phase to be off together: the loop stays stable while the torque
is multiplied by any complex number in the disk with the real diameter from (2 − α)/(2 + α) to
(2 + α)/(2 − α). α is the reciprocal of the largest :math:`|S - 1/2|` (Seiler, Packard, Gahinet, An
introduction to disk margins, IEEE Control Systems 40(5), 2020).
"""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from furuta.transfer import checked_feedback
from furuta_control.control import ControllerParameters
from furuta_model.linear import linearize
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum

POINTS = 20_000  # of the grid over ω for the disk margin
SPAN = 1e3  # of that grid beyond the slowest and fastest pole
REAL = 1e-6  # relative imaginary part below which a root is real


class Margins(NamedTuple):
    """Factors of the torque between which the loop is stable, phase [rad], delay [s], disk α."""

    gain_low: float
    gain_high: float
    phase_rad: float
    delay_s: float
    disk: float


def margins(p: FurutaPendulum, gain: np.ndarray, viscous: float = 0.0) -> Margins:
    """Margins of u = −Lx, ``gain`` = L (4,); :class:`ParameterError` if the loop is unstable.

    The pendulum's arm has ``viscous`` friction [V s/rad], which is not compensated.
    """
    a, b = linearize(p, viscous)
    opened = np.poly(a)
    closed = np.poly(a - np.outer(b, gain))
    poles = np.roots(closed)
    if np.max(poles.real) >= 0.0:
        raise ParameterError("an unstable loop has no margins")
    # On s = jω, as polynomials in ω.
    loop_gain, pendulum = _on_axis(closed - opened), _on_axis(opened)
    low, high = _gain_margins(loop_gain, pendulum)
    phase, delay = _phase_and_delay(loop_gain, pendulum)
    omega = np.geomspace(np.abs(poles).min() / SPAN, np.abs(poles).max() * SPAN, POINTS)
    s = 1j * omega
    sensitivity = np.polyval(opened, s) / np.polyval(closed, s)
    return Margins(low, high, phase, delay, float(1.0 / np.abs(sensitivity - 0.5).max()))


def linear_report(
    controller: ControllerParameters, feedback: Sequence[float] | None = None
) -> dict[str, Any]:
    """Linear model of the controller, poles, gain L and margins by name.

    ``feedback`` is l (4,) of u = l·x instead of the controller's; L = −l.
    """
    a, b = linearize(controller.model, controller.model_viscous)
    gain = -np.array(checked_feedback(feedback)) if feedback else np.array(controller.feedback_gain)
    closed = np.linalg.eigvals(a - np.outer(b, gain))
    report = {
        **controller.model._asdict(),
        "A": a.tolist(),
        "B": b.tolist(),
        "open_loop_poles": pairs(np.sort_complex(np.linalg.eigvals(a))),
        "L": gain.tolist(),
        "closed_loop_poles": pairs(np.sort_complex(closed)),
    }
    if np.all(closed.real < 0.0):
        report["margins"] = margins(controller.model, gain, controller.model_viscous)._asdict()
    return report


def pairs(roots: Iterable[complex]) -> list[list[float]]:
    """Complex numbers as lists of real and imaginary part."""
    return [[float(root.real), float(root.imag)] for root in roots]


def _on_axis(polynomial: np.ndarray) -> np.ndarray:
    powers = np.arange(len(polynomial))[::-1]
    return polynomial * (1j**powers)


def _gain_margins(loop_gain: np.ndarray, pendulum: np.ndarray) -> tuple[float, float]:
    """The nearest factors below and above 1 that put a pole on the imaginary axis."""
    crossings = np.polymul(loop_gain, pendulum.conj()).imag
    omega = _real_roots(crossings)
    factors = -(np.polyval(pendulum, omega) / np.polyval(loop_gain, omega)).real
    below, above = factors[(factors > 0.0) & (factors < 1.0)], factors[factors > 1.0]
    return float(below.max(initial=0.0)), float(above.min(initial=np.inf))


def _phase_and_delay(loop_gain: np.ndarray, pendulum: np.ndarray) -> tuple[float, float]:
    """The least phase lag [rad] and the least delay [s] that destabilise the loop."""
    difference: np.ndarray = np.polysub(
        np.polymul(loop_gain, loop_gain.conj()), np.polymul(pendulum, pendulum.conj())
    ).real
    omega = _real_roots(difference)
    angle = np.angle(np.polyval(loop_gain, omega) / np.polyval(pendulum, omega))
    lag = np.mod(angle + np.pi, 2.0 * np.pi)
    phase = np.minimum(lag, 2.0 * np.pi - lag)
    return float(phase.min(initial=np.pi)), float((lag / omega).min(initial=np.inf))


def _real_roots(polynomial: np.ndarray) -> np.ndarray:
    """The positive real roots."""
    roots = np.roots(polynomial)
    roots = roots[np.abs(roots.imag) < REAL * np.abs(roots)].real
    return roots[roots > 0.0]
