r"""Describing functions of the friction laws: the response of friction to a sinusoidal speed.

At v = A sin ωt friction is periodic. N is the ratio of its fundamental to v, a complex number
[V s/rad]; its angle is the phase by which the fundamental leads v. With the viscous part σ₂:

==========  ===============================================================================
coulomb     :math:`N = 4α_0/(πA) + σ_2`
stiction    the same: a sinusoid is at v = 0 only for an instant, so stiction has no effect
stribeck    :math:`N = (4/πA)(α_0 + α_1D(a)/a) + σ_2,\ a = A/v_s`, D Dawson's integral
lugre       :math:`N = (σ_0 + jωσ_1)Z_1/A + σ_2`, Z₁ the bristle's fundamental
            (:mod:`furuta.describing_functions.bristle_cycle`)
==========  ===============================================================================

With asymmetric levels, (1 ± a), friction also has a mean: :func:`bias`. For the first three laws
the fundamental is exactly that of the mean level. For LuGre this holds to first order in a, and the
mean level is used. If φ is not fed back, the mean force also shifts the mean of v; that is
neglected.

Limit cycles are the zeros of the residual H(A, ω) = 1/G(jω) + N(A, ω). They are those of 1 + G N,
but H is finite for all A, ω > 0, because the only zero of G on the imaginary axis is ω = 0.
"""

from math import pi

import numpy as np

from furuta.describing_functions.bristle_cycle import STEPS, bristle_fundamental
from furuta.describing_functions.levels import fundamental_level, mean_level
from furuta.transfer import Transfer
from furuta_model.friction.laws import FrictionLaw
from furuta_model.parameters import ParameterError

# Relative step of the central differences; their relative error is 1e-10.
STEP = 1e-5


def describing_function(amplitude: float, omega: float, law: FrictionLaw) -> complex:
    """Describing function N(A, ω) of friction, for the arm speed v = A sin ωt.

    Args:
        amplitude: A [rad/s], above 0.
        omega: ω [rad/s], above 0.
        law: What :func:`furuta.friction_law` returns.

    Returns:
        N [V s/rad].

    Raises:
        ParameterError: Amplitude or frequency is not above 0 and finite.
    """
    if not (0.0 < amplitude < np.inf and 0.0 < omega < np.inf):
        raise ParameterError(
            "a describing function needs amplitude and frequency above 0, "
            f"given {amplitude:g} rad/s and {omega:g} rad/s"
        )
    if law.bristle:
        p = law.parameters
        deflection = bristle_fundamental(amplitude, omega, law, STEPS)
        return complex(p.sigma0, omega * p.sigma1) * deflection / amplitude + p.viscous
    return complex(static_describing_function(amplitude, law))


def static_describing_function(amplitude: float, law: FrictionLaw) -> float:
    """N(A) [V s/rad] of a law that depends on the present speed alone; A > 0 [rad/s]."""
    level = fundamental_level(amplitude, law.law, law.parameters)
    return 4.0 * level / (pi * amplitude) + law.parameters.viscous


def bias(amplitude: float, law: FrictionLaw) -> float:
    """Mean friction [V] at v = A sin ωt with asymmetric levels.

    It is the asymmetry times the mean of g(A sin x) over a cycle. The feedback of φ balances it by
    a constant arm offset of bias/l₁. For LuGre it is valid for a sliding arm; with motions smaller
    than the deflection of the bristle the bias is smaller.
    """
    return law.parameters.asymmetry * mean_level(amplitude, law.law, law.parameters)


def residual(amplitude: float, omega: float, g: Transfer, law: FrictionLaw) -> complex:
    """H [V s/rad] at A [rad/s] and ω [rad/s]."""
    return complex(g.inverse_at(omega)) + describing_function(amplitude, omega, law)


def residual_slopes(
    amplitude: float, omega: float, g: Transfer, law: FrictionLaw
) -> tuple[complex, complex]:
    """∂H/∂A and ∂H/∂ω."""
    da, dw = STEP * amplitude, STEP * omega
    up, down = (residual(amplitude + step, omega, g, law) for step in (da, -da))
    right, left = (residual(amplitude, omega + step, g, law) for step in (dw, -dw))
    return (up - down) / (2 * da), (right - left) / (2 * dw)
