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

from typing import NamedTuple

import numpy as np

from furuta_model.linear import linearize
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum

POINTS = 20_000  # of the grid over ω for the disk margin
SPAN = 1e3  # of that grid beyond the slowest and fastest pole


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
    gains, crossovers, lags = _crossings(closed - opened, opened)
    grid = np.geomspace(np.abs(poles).min() / SPAN, np.abs(poles).max() * SPAN, POINTS)
    sensitivity = np.polyval(opened, 1j * grid) / np.polyval(closed, 1j * grid)
    return Margins(
        float(gains[gains < 1.0].max(initial=0.0)),
        float(gains[gains > 1.0].min(initial=np.inf)),
        float(np.minimum(lags, 2.0 * np.pi - lags).min(initial=np.pi)),
        float((lags / crossovers).min(initial=np.inf)),
        float(1.0 / np.abs(sensitivity - 0.5).max()),
    )


def _crossings(
    numerator: np.ndarray, denominator: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where L(jω) = n/d meets the negative real axis, and where the unit circle.

    Returns:
        Gains with which L meets −1 on the axis; ω [rad/s] of |L| = 1, and there the phase [rad]
        from −1 to L, 0 to 2π, which is the lag that the loop bears.
    """
    turns = np.resize([1.0, 1j, -1.0, -1j], denominator.size)[::-1]  # s = jω
    n, d = numerator * turns, denominator * turns
    product = np.polymul(n, d.conj())  # has the phase of L
    on_axis = _real_roots(product.imag)
    on_axis = on_axis[(on_axis >= 0.0) & (np.polyval(product.real, on_axis) < 0.0)]
    with np.errstate(divide="ignore"):  # of an integrator at ω = 0
        gains = 1.0 / np.abs(np.polyval(n, on_axis) / np.polyval(d, on_axis))
    crossovers = _real_roots(np.polysub(np.polymul(n, n.conj()), np.polymul(d, d.conj())).real)
    crossovers = crossovers[crossovers > 0.0]
    phases = np.angle(-np.polyval(n, crossovers) / np.polyval(d, crossovers))
    return gains, crossovers, np.mod(phases, 2.0 * np.pi)


def _real_roots(polynomial: np.ndarray) -> np.ndarray:
    roots = np.roots(polynomial)
    real: np.ndarray = roots[np.isreal(roots)].real
    return real
