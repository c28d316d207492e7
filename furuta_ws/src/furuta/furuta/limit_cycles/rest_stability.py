r"""Stability of a loop at rest, and the directions in which a disturbance grows.

What follows is about the pendulum. Of a linear loop at rest or in steady motion the eigenvalues of
each side of v = 0 decide. Under a law that truly sticks an integrator leads away from every rest
with the slightest error; what follows shows whether the motion comes back.

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

The eigenvalue 0 along the line of rests is left out: a disturbance leads to the next rest.
"""

from typing import NamedTuple

import numpy as np

from furuta.limit_cycles.friction_loop import FrictionLoop, rate, rest_distance, stuck_rate
from furuta.limit_cycles.linear_loop import LinearLoop, W
from furuta.limit_cycles.pendulum_loop import IdealLoop, rest_near
from furuta.oscillation import FRICTIONLESS
from furuta_model.friction.laws import breakaway_level, sliding_level
from furuta_model.friction.lugre import highest_level
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

DIFFERENCE = 1e-6  # of the finite differences
DIFFERENCE_OF_VELOCITY = 3e-4  # of that of a linear loop's speed, relative to the Stribeck velocity
ZERO = 1e-4  # an eigenvalue of this size belongs to a line of rests
STILL = 1e-5  # speed of a joint at rest
NEWTON_STEPS = 10


class RestStability(NamedTuple):
    """Largest growth rate [1/s] of a disturbance, and the growing directions of the state."""

    growth_rate: float
    directions: tuple[np.ndarray, ...]


def rest_stability(y: np.ndarray, loop: FrictionLoop) -> RestStability:
    """The stability of the rest ``y``."""
    if isinstance(loop, LinearLoop):
        return _linear(y, loop)
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


def rest_state(y: np.ndarray, loop: FrictionLoop) -> np.ndarray:
    """The rest that the motion has reached at ``y``."""
    if isinstance(loop, LinearLoop):
        rest = y.copy()
        if abs(y[PHI_DOT]) > STILL:
            return _steady(rest, loop)
        if not loop.law.bristle:
            rest[PHI_DOT] = 0.0
        return rest
    law = loop.law
    stuck = not law.bristle and highest_level(law.parameters) > FRICTIONLESS
    rest = np.zeros(PLANT_STATES)
    rest[PHI], held = rest_near(y, 0.0 if stuck else 1.0, loop)
    if law.bristle:
        rest[BRISTLE] = held / law.parameters.sigma0
    return rest


def _steady(y: np.ndarray, loop: LinearLoop) -> np.ndarray:
    """The steady motion near ``y``: close to the Stribeck velocity its stability needs all digits.

    By Newton's method; what is no closer than ``y`` is not taken.
    """
    mode, dy = float(np.sign(y[PHI_DOT])), np.empty(loop.states)
    for _ in range(NEWTON_STEPS):
        rate(y, mode, loop, dy)
        slopes, before = _slopes(y, mode, loop), y.copy()
        moved = slice(PHI_DOT, PHI_DOT + len(slopes))
        y[moved] -= np.linalg.lstsq(slopes, dy[moved], rcond=None)[0]
        if not rest_distance(y, mode, loop) < rest_distance(before, mode, loop):
            return before
    return y


def _linear(y: np.ndarray, loop: LinearLoop) -> RestStability:
    """By the eigenvalues of ẏ, without those of a line of rests."""
    v = y[PHI_DOT]
    if abs(v) > STILL:
        return RestStability(_growth(_slopes(y, float(np.sign(v)), loop)), ())
    if loop.law.bristle:
        return RestStability(max(_growth(_slopes(y, side, loop)) for side in (1.0, -1.0)), ())
    stuck = _slopes(y, 0.0, loop)[1:, 1:]
    growth, direction = _growth(stuck), _drift(stuck)
    if direction is None or growth > 0.0:
        return RestStability(growth, ())
    # An integrator moves the holding force, however small the error: what follows decides.
    disturbance, drift = np.zeros(loop.states), np.zeros(loop.states)
    disturbance[W:-1] = direction
    if loop.law.parameters.asymmetry != 0.0 or np.any(loop.r):
        # An error of either sign may come first. It is that against the one that is left, so that
        # mirror images of a loop end in mirror images.
        stuck_rate(y, drift, loop)
        disturbance *= -np.sign(drift[W:-1] @ stuck @ direction) or 1.0
    return RestStability(0.0, (disturbance, -disturbance))


def _slopes(y: np.ndarray, mode: float, loop: LinearLoop) -> np.ndarray:
    """dẏ/dy of v, w and, under a law with a bristle, z."""
    last = loop.states if loop.law.bristle else loop.states - 1
    columns = []
    steepest = DIFFERENCE_OF_VELOCITY * loop.law.parameters.stribeck_velocity or DIFFERENCE
    for i in range(PHI_DOT, last):
        size = min(DIFFERENCE, steepest) if i == PHI_DOT else DIFFERENCE
        ends = np.empty((2, loop.states))
        for end, step in zip(ends, (size, -size), strict=True):
            moved = y.copy()
            moved[i] += step
            rate(moved, mode, loop, end)
        columns.append((ends[0] - ends[1])[PHI_DOT:last] / (2.0 * size))
    return np.array(columns).T


def _growth(slopes: np.ndarray) -> float:
    eigenvalues = np.linalg.eigvals(slopes)
    others = eigenvalues[np.abs(eigenvalues) > ZERO]
    return float(others.real.max(initial=-np.inf))


def _drift(stuck: np.ndarray) -> np.ndarray | None:
    """The disturbance of w by which w drifts at the constant rate 1; None if there is none."""
    _, sizes, vectors = np.linalg.svd(stuck @ stuck)
    constant = vectors[sizes < ZERO * max(1.0, float(sizes.max(initial=0.0)))]
    drifts = stuck @ constant.T
    if drifts.size == 0 or np.abs(drifts).max() < ZERO:
        return None
    strongest = int(np.argmax(np.abs(drifts).max(axis=0)))
    return np.asarray(constant[strongest] / np.abs(drifts[:, strongest]).max())


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
