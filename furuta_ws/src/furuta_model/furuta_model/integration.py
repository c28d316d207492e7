r"""Integrates the plant over one sample: rigid body and friction under constant voltage.

The method is an exponential midpoint rule. For a law with bristle, eq. (5), each stage moves the
bristle by its exact solution at the stage's speed and drives the body with the exact mean of the
friction over that stage. σ₁ż integrates to σ₁Δz at any rate of the bristle, so the speed does not
limit the step. The error is of second order in the substep. Two parts are explicit: the bristle as
a spring and damper between arm and ground, and the rotation of the body. Substeps keep the rates
of both, times the step, small.

For a law without bristle, friction brings the arm to rest within a step if its level is high
enough, and then holds it. The arm truly sticks; a reversal is late by at most one substep.

The rule works for any rigid body (:func:`integrator`): the paper's pendulum and, in
identification, one on a tilted base.
"""

from collections.abc import Callable
from math import ceil, sqrt
from typing import Any, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.elementary import sin_cos
from furuta_model.friction.laws import (
    FrictionLaw,
    bristle_force,
    sticking_force,
)
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum, accelerations_at, rotate_slightly
from furuta_model.state import BRISTLE, PHI, PHI_DOT, THETA, THETA_DOT

# Largest rate times substep of the arm stuck on its bristle. The midpoint rule is stable below 2.
LARGEST_STEP = 0.25
# Limits the computing time per sample; reached only at speeds far above those of any rig.
MAX_SUBSTEPS = 10_000


class Point(NamedTuple):
    """Where a stage is evaluated: φ [rad], φ̇ and θ̇ [rad/s], sine and cosine of θ."""

    phi: float
    v: float
    sine: float
    cosine: float
    w: float


# One stage of the rule: accelerations (φ̈, θ̈) [rad/s²] under the mean friction over the stage, and
# the friction law's memory at its end. Its arguments: the point, φ̇ at the start of the substep,
# u [V], the memory at the start, the length of the stage [s], body and friction law.
Stage = Callable[[Point, float, float, float, float, Any, FrictionLaw], tuple[float, float, float]]


def substeps_for(dt: float, pendulum: FurutaPendulum, friction: Friction) -> int:
    """Number of substeps that resolve the stuck arm over a sample of ``dt`` [s]."""
    mobility = pendulum.beta / pendulum.determinant
    spring = sqrt(friction.sigma0 * mobility)
    damper = (friction.sigma1 + friction.viscous) * mobility
    gravity = sqrt(pendulum.alpha * pendulum.delta / pendulum.determinant)
    return max(1, ceil(dt * (spring + damper + gravity) / LARGEST_STEP))


@inlined
def _nothing(body: Any) -> None:
    """A body without memory of its own."""


def integrator(
    stage: Stage, after_substep: Callable[[Any], None] = _nothing
) -> Callable[[np.ndarray, float, float, int, Any, FrictionLaw], None]:
    """Make the midpoint rule for a body and its friction, given by its ``stage`` (compiled).

    ``after_substep`` (inlined) gets the body at the end of each substep. The returned function is
    inlined into its callers.
    """
    first_half, whole = first_half_rule(stage), whole_rule(stage)

    def advance(
        x: np.ndarray, u: float, dt: float, substeps: int, body: Any, law: FrictionLaw
    ) -> None:
        """Integrate state ``x`` (5,) in place over ``dt`` [s] at constant torque ``u`` [V]."""
        substeps = sufficient_substeps(x, dt, substeps)
        h = dt / substeps
        for _ in range(substeps):
            sine, cosine = sin_cos(x[THETA])
            v_mid, w_mid = first_half(x, u, h, sine, cosine, body, law)
            whole(x, u, h, sine, cosine, v_mid, w_mid, body, law)
            after_substep(body)

    return inlined(advance, cached=False)


@inlined
def sufficient_substeps(x: np.ndarray, dt: float, substeps: int) -> int:
    """Number of substeps: ``substeps``, or more if the body would rotate far in one of them."""
    angle = dt * (abs(x[PHI_DOT]) + abs(x[THETA_DOT]))
    if angle > LARGEST_STEP * substeps:
        substeps = ceil(min(angle / LARGEST_STEP, MAX_SUBSTEPS))
    return substeps


def first_half_rule(stage: Stage) -> Callable[..., tuple[float, float]]:
    """Make the first half of a substep of ``h`` [s]: the speeds in its middle [rad/s]."""

    def first_half(
        x: np.ndarray, u: float, h: float, sine: float, cosine: float, body: Any, law: FrictionLaw
    ) -> tuple[float, float]:
        half = 0.5 * h
        at = Point(x[PHI], x[PHI_DOT], sine, cosine, x[THETA_DOT])
        v_dot, w_dot, _ = stage(at, at.v, u, x[BRISTLE], half, body, law)
        return at.v + half * v_dot, at.w + half * w_dot

    return inlined(first_half, cached=False)


def whole_rule(stage: Stage) -> Callable[..., None]:
    """Make the whole substep from its start and the speeds in its middle."""

    def whole(
        x: np.ndarray,
        u: float,
        h: float,
        sine: float,
        cosine: float,
        v_mid: float,
        w_mid: float,
        body: Any,
        law: FrictionLaw,
    ) -> None:
        half = 0.5 * h
        phi, v, theta, w = x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT]
        sine, cosine = rotate_slightly(sine, cosine, half * w)
        middle = Point(phi + half * v, v_mid, sine, cosine, w_mid)
        v_dot, w_dot, end = stage(middle, v, u, x[BRISTLE], h, body, law)
        x[PHI] = phi + h * v_mid
        x[PHI_DOT] = v + h * v_dot
        x[THETA] = theta + h * w_mid
        x[THETA_DOT] = w + h * w_dot
        x[BRISTLE] = end

    return inlined(whole, cached=False)


@inlined
def _pendulum_stage(
    at: Point,
    start_speed: float,
    u: float,
    memory: float,
    h: float,
    body: FurutaPendulum,
    law: FrictionLaw,
) -> tuple[float, float, float]:
    """A stage of the paper's pendulum under any friction law."""
    _, v, sine, cosine, w = at
    driven = u - law.parameters.viscous * v
    if law.bristle:
        friction, end = bristle_force(v, memory, h, law)
    else:
        free, _ = accelerations_at(v, sine, cosine, w, driven, body)
        with_unit_torque, _ = accelerations_at(v, sine, cosine, w, driven + 1.0, body)
        holding = (start_speed / h + free) / (with_unit_torque - free)
        friction = sticking_force(v, start_speed, holding, law)
        end = friction
    v_dot, w_dot = accelerations_at(v, sine, cosine, w, driven - friction, body)
    return v_dot, w_dot, end


advance = integrator(_pendulum_stage)
# The two halves of a substep of ``advance``, for loops side by side.
advance_half, advance_whole = first_half_rule(_pendulum_stage), whole_rule(_pendulum_stage)
