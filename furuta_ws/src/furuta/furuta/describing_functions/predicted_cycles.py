r"""Predicts limit cycles with the describing function: solutions of 1 + G(jω)N(A, ω) = 0.

They are computed as zeros of the residual H(A, ω) = 1/G(jω) + N(A, ω) = U + jV. Stability follows
from Loeb's quasi-static criterion. If the amplitude is off by δA, the oscillation decays at the
rate σ for which H stays zero at the complex frequency ω + δω + jσ: H_A δA + H_ω(δω + jσ) = 0, hence
σ = (U_A V_ω − V_A U_ω) δA/|H_ω|². The amplitude returns if

.. math::
    U_AV_ω - V_AU_ω > 0

For a law that depends on the present speed alone, V_A = 0 and U_A = dN/dA < 0. The criterion only
covers the oscillating pair of poles. With N fixed at its real part n, the other roots of D + nB,
with G = B/D, must be stable too.

``control.describing_function_response`` knows neither N(ω) nor stability, and drops small cycles.
"""

from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np

from furuta.describing_functions.describing_function import (
    bias,
    describing_function,
    residual_slopes,
    static_describing_function,
)
from furuta.describing_functions.lugre_cycles import search
from furuta.transfer import Transfer
from furuta_model.friction.laws import FrictionLaw


class PredictedCycle(NamedTuple):
    """A limit cycle v = A sin ωt + mean: ω [rad/s], A [rad/s], arm peak to peak 2A/ω [rad].

    ``stable`` is quasi-static (see the module), ``bias_v`` the mean friction [V].
    """

    omega_rad_s: float
    velocity_amplitude_rad_s: float
    phi_peak_to_peak_rad: float
    period_s: float
    stable: bool
    bias_v: float


@dataclass(frozen=True)
class Prediction:
    """All predicted limit cycles in order of amplitude, and the range that was searched.

    The ranges of ω [rad/s] and of the arm amplitude A/ω [rad] are unlimited for laws that depend on
    the present speed alone. ``complete``: the number of cycles agrees with the winding number.
    """

    cycles: tuple[PredictedCycle, ...]
    omega_range_rad_s: tuple[float, float] = (0.0, float("inf"))
    phi_amplitude_range_rad: tuple[float, float] = (0.0, float("inf"))
    complete: bool = True


def predict_cycles(g: Transfer, law: FrictionLaw) -> Prediction:
    """All solutions of 1 + G(jω)N(A, ω) = 0 with ω > 0."""
    if law.parameters.alpha0 + law.parameters.alpha1 <= 0.0:
        return Prediction(())
    if not law.bristle:
        cycles = [
            _cycle(amplitude, omega, g, law)
            for omega, real in g.crossings
            if omega > 0.0 and (amplitude := _amplitude(-1.0 / real, law)) is not None
        ]
        return Prediction(_sorted(cycles))
    roots, omegas, deflections, complete = search(g, law)
    return Prediction(
        _sorted([_cycle(amplitude, omega, g, law) for amplitude, omega in roots]),
        omegas,
        deflections,
        complete,
    )


def _amplitude(gain: float, law: FrictionLaw) -> float | None:
    """A [rad/s] at which N(A) is ``gain`` [V s/rad], or None. N falls with A, so A is unique.

    The level lies between α₀ and α₀ + α₁, which brackets A.
    """
    p = law.parameters
    excess = gain - p.viscous
    if excess <= 0.0:
        return None
    low, high = 4.0 * p.alpha0 / (pi * excess), 4.0 * (p.alpha0 + p.alpha1) / (pi * excess)
    if law.law.constant or p.alpha1 == 0.0:
        return low if low > 0.0 else None

    from scipy.optimize import brentq

    def excess_at(amplitude: float) -> float:
        return static_describing_function(amplitude, law) / gain - 1.0

    return float(brentq(excess_at, max(low, 1e-9 * high) * (1 - 1e-9), high * (1 + 1e-9)))


def _cycle(amplitude: float, omega: float, g: Transfer, law: FrictionLaw) -> PredictedCycle:
    by_amplitude, by_omega = residual_slopes(amplitude, omega, g, law)
    decay = float(np.imag(np.conj(by_amplitude) * by_omega))
    return PredictedCycle(
        omega,
        amplitude,
        2.0 * amplitude / omega,
        2.0 * pi / omega,
        decay > 0.0 and _others_decay(amplitude, omega, g, law),
        bias(amplitude, law),
    )


def _others_decay(amplitude: float, omega: float, g: Transfer, law: FrictionLaw) -> bool:
    """Whether all poles but the oscillating pair decay, with N fixed at its real part."""
    n = describing_function(amplitude, omega, law).real
    poles = np.roots(np.polyadd(g.denominator, n * np.array(g.numerator)))
    others = poles[np.argsort(np.abs(poles**2 + omega**2))][2:]
    return bool(np.all(others.real <= 0.0))


def _sorted(cycles: list[PredictedCycle]) -> tuple[PredictedCycle, ...]:
    return tuple(sorted(cycles, key=lambda cycle: cycle.phi_peak_to_peak_rad))
