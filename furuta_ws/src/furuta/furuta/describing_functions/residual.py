"""Residual H(A, ω) = 1/G(jω) + N(A, ω) of the harmonic balance [V s/rad], and its derivatives.

It has the same zeros as 1 + G N, but is finite for all A, ω > 0, because the only zero of G on the
imaginary axis is ω = 0.
"""

from furuta.describing_functions.describing_function import describing_function
from furuta_model.friction.laws import FrictionLaw
from furuta_model.transfer import Transfer

# Relative step of the central differences; their relative error is 1e-10.
STEP = 1e-5


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
