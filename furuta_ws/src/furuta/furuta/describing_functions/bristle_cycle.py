r"""Periodic motion of the bristle at v = A sin ωt, for the describing function of LuGre.

With τ = ωt and the arm's amplitude X = A/ω, eq. (5) reads

.. math::
    dz/dτ = X\sinτ - \frac{σ_0X|\sinτ|}{g(A\sinτ)}z

It is linear in z, so a half cycle maps z(0) to z(π) = m z(0) + c. Two integrations give m and c and
thus the only periodic solution, z(π) = −z(0). The integration method is Radau IIA with three
stages. It is of fifth order and stable at any rate of the bristle. Its nodes are dense at the
reversals, where the deflection changes sign within α₀/σ₀ and g(v) varies within vs.
"""

from math import cos, pi, sin, sinh, sqrt

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.friction.laws import FrictionLaw, symmetric_level
from furuta_model.friction.lugre import deflection_rate
from furuta_model.friction.parameters import SMALLEST_LEVEL

# Steps per quarter cycle. The relative error of N is then about 1e-7, far less at usual amplitudes.
STEPS = 32
# Radau IIA with three stages: nodes and matrix. The last row of the matrix holds the weights.
_ROOT = sqrt(6.0)
C1, C2 = (4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0
A11, A12, A13 = (
    (88.0 - 7.0 * _ROOT) / 360.0,
    (296.0 - 169.0 * _ROOT) / 1800.0,
    (-2.0 + 3.0 * _ROOT) / 225.0,
)
A21, A22, A23 = (
    (296.0 + 169.0 * _ROOT) / 1800.0,
    (88.0 + 7.0 * _ROOT) / 360.0,
    (-2.0 - 3.0 * _ROOT) / 225.0,
)
B1, B2, B3 = (16.0 - _ROOT) / 36.0, (16.0 + _ROOT) / 36.0, 1.0 / 9.0


@compiled
def bristle_fundamental(amplitude: float, omega: float, law: FrictionLaw, steps: int) -> complex:
    """Z₁ [rad] of z ≈ Im(Z₁ exp(jωt)) under v = A sin ωt, A [rad/s], ω [rad/s].

    ``steps`` is the number of steps per quarter cycle. The asymmetry is not included.
    """
    nodes = _nodes(amplitude, omega, law, steps)
    end, _, _ = _half_cycle(0.0, nodes, amplitude, omega, law)
    shifted, _, _ = _half_cycle(1.0, nodes, amplitude, omega, law)
    start = -end / (1.0 + shifted - end)
    _, in_phase, quadrature = _half_cycle(start, nodes, amplitude, omega, law)
    return complex(2.0 / pi * in_phase, 2.0 / pi * quadrature)


@compiled
def _nodes(amplitude: float, omega: float, law: FrictionLaw, steps: int) -> np.ndarray:
    """Phases τ from 0 to π, dense at both ends: a sinh of equal steps."""
    p = law.parameters
    level = max(p.alpha0 + p.alpha1, SMALLEST_LEVEL)
    sign_change = sqrt(2.0 * level * omega / (p.sigma0 * amplitude))
    scale = max(min(1.0, sign_change, p.stribeck_velocity / amplitude), 1e-9)
    reach = np.arcsinh(0.5 * pi / scale)
    nodes = np.empty(2 * steps + 1)
    for i in range(steps + 1):
        nodes[i] = scale * sinh(reach * i / steps)
        nodes[2 * steps - i] = pi - nodes[i]
    return nodes


@compiled
def _half_cycle(
    z: float, nodes: np.ndarray, amplitude: float, omega: float, law: FrictionLaw
) -> tuple[float, float, float]:
    """z(π) and the integrals of z sin τ and z cos τ over the half cycle, from z at τ = 0."""
    in_phase = quadrature = 0.0
    for i in range(len(nodes) - 1):
        t, h = nodes[i], nodes[i + 1] - nodes[i]
        t1, t2, t3 = t + C1 * h, t + C2 * h, t + h
        s1, k1 = _source_and_rate(t1, amplitude, omega, law)
        s2, k2 = _source_and_rate(t2, amplitude, omega, law)
        s3, k3 = _source_and_rate(t3, amplitude, omega, law)
        z1, z2, z3 = _solve3(
            (1.0 + h * A11 * k1, h * A12 * k2, h * A13 * k3),
            (h * A21 * k1, 1.0 + h * A22 * k2, h * A23 * k3),
            (h * B1 * k1, h * B2 * k2, 1.0 + h * B3 * k3),
            (
                z + h * (A11 * s1 + A12 * s2 + A13 * s3),
                z + h * (A21 * s1 + A22 * s2 + A23 * s3),
                z + h * (B1 * s1 + B2 * s2 + B3 * s3),
            ),
        )
        in_phase += h * (B1 * z1 * sin(t1) + B2 * z2 * sin(t2) + B3 * z3 * sin(t3))
        quadrature += h * (B1 * z1 * cos(t1) + B2 * z2 * cos(t2) + B3 * z3 * cos(t3))
        z = z3
    return z, in_phase, quadrature


@compiled
def _source_and_rate(
    phase: float, amplitude: float, omega: float, law: FrictionLaw
) -> tuple[float, float]:
    """The two terms of dz/dτ = source − rate z."""
    source = amplitude / omega * sin(phase)
    level = symmetric_level(amplitude * sin(phase), law)
    return source, -deflection_rate(0.0, abs(source), 1.0, level, law.parameters)


Row = tuple[float, float, float]


@compiled
def _solve3(a: Row, b: Row, c: Row, right: Row) -> Row:
    """Solve rows a, b, c by elimination; the matrix of the stages needs no pivoting."""
    f, g = b[0] / a[0], c[0] / a[0]
    b1, b2, y = b[1] - f * a[1], b[2] - f * a[2], right[1] - f * right[0]
    c1, c2, w = c[1] - g * a[1], c[2] - g * a[2], right[2] - g * right[0]
    f = c1 / b1
    third = (w - f * y) / (c2 - f * b2)
    second = (y - b2 * third) / b1
    return (right[0] - a[1] * second - a[2] * third) / a[0], second, third
