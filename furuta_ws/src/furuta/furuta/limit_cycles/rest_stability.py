r"""Stability of the ideal loop at rest, and the directions in which a disturbance grows.

**Bristle.** At v = 0, θ = 0 every deflection z that balances l₁φ = σ₀z is a rest. There (5) is
linear on each side of v = 0: :math:`\dot z = (1 ∓ ρ)v` for v ≷ 0 with the strain ρ = σ₀z/g(0). The
arm hangs on a spring σ₀(1 ∓ ρ) and a damper σ₁(1 ∓ ρ) + σ₂. The characteristic polynomial of a side
has the constant term δ(l₁ − σ₀(1 ∓ ρ))/(αβ − γ²). If that is negative, there is a positive real
eigenvalue. Its eigenvector has one sign of v, so the motion along it stays on its side and is a
motion of the loop: if l₁ < σ₀(1 + |ρ|), the rest is unstable. A bristle stiffer than l₁ therefore
has no stable rest. Otherwise all eigenvalues of both sides decide. Without strain that is exact;
with strain, motions that change sides again and again are not covered.

**True sticking.** The stuck arm is a fixed base: β θ̈ = δθ, so a disturbance of θ grows with
√(δ/β) until the arm breaks away. Every rest is unstable, also one that the sliding arm reaches.

**No friction.** The loop is smooth, and its eigenvalues decide.

The eigenvalue 0 along the line of rests is left out: a disturbance moves the arm to the next rest.
"""

from typing import NamedTuple

import numpy as np

from furuta.limit_cycles.ideal_loop import IdealLoop
from furuta_model.friction.laws import breakaway_level, sliding_level
from furuta_model.linear import linearize
from furuta_model.state import (
    BRISTLE,
    PHI,
    PHI_DOT,
    PLANT_STATES,
    RIGID_STATES,
    THETA,
    THETA_DOT,
)


class RestStability(NamedTuple):
    """Largest growth rate [1/s] of a disturbance, and the growing directions (5,) of the state."""

    growth_rate: float
    directions: tuple[np.ndarray, ...]


def rest_stability(y: np.ndarray, loop: IdealLoop) -> RestStability:
    """The stability of the rest ``y`` (5,)."""
    if loop.law.bristle:
        sides = [_side(y, direction, loop) for direction in (1.0, -1.0)]
        return RestStability(
            max(rate for rate, _ in sides),
            tuple(direction for rate, direction in sides if rate > 0.0),
        )
    if breakaway_level(1.0, loop.law) + breakaway_level(-1.0, loop.law) > 0.0:
        return _stuck(loop)
    rate, direction = _fastest(loop, 0.0, 0.0)
    return RestStability(rate, (direction, -direction) if rate > 0.0 else ())


def _side(y: np.ndarray, direction: float, loop: IdealLoop) -> tuple[float, np.ndarray]:
    """Growth rate and fastest direction of the motions with v in ``direction`` (±1)."""
    p = loop.law.parameters
    slack = 1.0 - direction * p.sigma0 * y[BRISTLE] / sliding_level(0.0, direction, loop.law)
    rate, fastest = _fastest(loop, p.sigma0 * slack, p.sigma1 * slack)
    fastest = fastest * direction * (np.sign(fastest[PHI_DOT]) or 1.0)
    fastest[BRISTLE] = slack * fastest[PHI]
    return rate, fastest


def _fastest(loop: IdealLoop, stiffness: float, damping: float) -> tuple[float, np.ndarray]:
    """Eigenvalue with the largest real part [1/s] of the arm on a spring and damper; its vector."""
    a, b = linearize(loop.body)
    reduction = np.array([stiffness, damping + loop.law.parameters.viscous, 0.0, 0.0])
    closed = a + np.outer(b, np.array(loop.gains) - reduction)
    eigenvalues, vectors = np.linalg.eig(closed)
    n = int(np.argmax(eigenvalues.real))
    y = np.zeros(PLANT_STATES)
    y[:RIGID_STATES] = vectors[:, n].real
    return float(eigenvalues[n].real), y / np.abs(y).max()


def _stuck(loop: IdealLoop) -> RestStability:
    growth = float(np.sqrt(loop.body.delta / loop.body.beta))
    tilt = np.zeros(PLANT_STATES)
    tilt[THETA], tilt[THETA_DOT] = 1.0 / growth, 1.0
    return RestStability(growth, (tilt, -tilt))
