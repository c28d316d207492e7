r"""One sample of the plant: rigid body and friction together under constant voltage.

An exponential midpoint rule. Under a law with bristle, eq. (5), each stage moves the bristle by
its exact solution at the stage's speed and drives the body with the exact mean of the friction
over that stage; σ₁ż integrates to σ₁Δz whatever the rate of the bristle, so speed never limits the
step. The error is of second order in the substep. What remains explicit is the bristle as a spring
and damper between arm and ground, and the rotation of the body; substeps keep the rates of both
times the step small.

Under a law without bristle friction brings the arm to rest within a step where its level allows
that, and then holds it. The arm truly sticks; a reversal is late by at most one substep.

The rule serves any rigid body (:func:`integrator`): the paper's pendulum and, in identification,
one on a tilted base.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, cos, sin, sqrt
from typing import Any

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import (
    BRISTLE as HAS_BRISTLE,
)
from furuta_model.friction.laws import (
    FrictionLaw,
    bristle_force,
    sticking_force,
)
from furuta_model.friction.parameters import LuGre
from furuta_model.pendulum import FurutaPendulum, accelerations_at, rotate
from furuta_model.state import BRISTLE, PHI, PHI_DOT, THETA, THETA_DOT

# Rate of the stuck arm on its bristle times the substep: the midpoint rule is stable below 2.
LARGEST_STEP = 0.25
# Bound of the work per sample: reached only at speeds that no rig survives.
MOST_SUBSTEPS = 10_000

# One stage of the rule: accelerations (φ̈, θ̈) [rad/s²] under the mean friction over the stage, and
# the friction law's memory at its end. Its arguments: φ, φ̇, θ, sin θ, cos θ, θ̇ at which the stage
# is evaluated, φ̇ at the start of the step, u [V], the memory at the start, the length of the stage
# [s], body and friction law.
Stage = Callable[..., tuple[float, float, float]]


def substeps_for(dt: float, pendulum: FurutaPendulum, friction: LuGre) -> int:
    """Substeps that keep the stuck arm well resolved over a sample of ``dt`` [s]."""
    mobility = pendulum.beta / pendulum.determinant
    spring = sqrt(friction.sigma0 * mobility)
    damper = (friction.sigma1 + friction.viscous) * mobility
    gravity = sqrt(pendulum.alpha * pendulum.delta / pendulum.determinant)
    return max(1, ceil(dt * (spring + damper + gravity) / LARGEST_STEP))


def integrator(stage: Stage) -> Callable[..., None]:
    """The midpoint rule for a body and its friction, given by its ``stage`` (compiled).

    The function made has the arguments of :func:`advance`. It is compiled into its callers.
    """

    def advance(
        x: np.ndarray, u: float, dt: float, substeps: int, body: Any, law: FrictionLaw
    ) -> None:
        # The body turns by an angle in each step: at high speed that, too, must be small.
        turn = dt * (abs(x[PHI_DOT]) + abs(x[THETA_DOT]))
        if turn > LARGEST_STEP * substeps:
            substeps = ceil(min(turn / LARGEST_STEP, MOST_SUBSTEPS))
        h = dt / substeps
        half = 0.5 * h
        for _ in range(substeps):
            phi, v, theta, w, memory = x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT], x[BRISTLE]

            sine, cosine = sin(theta), cos(theta)
            v_dot, w_dot, _ = stage(phi, v, theta, sine, cosine, w, v, u, memory, half, body, law)
            phi_mid, theta_mid = phi + half * v, theta + half * w
            v_mid, w_mid = v + half * v_dot, w + half * w_dot
            sine, cosine = rotate(sine, cosine, half * w)

            v_dot, w_dot, end = stage(
                phi_mid, v_mid, theta_mid, sine, cosine, w_mid, v, u, memory, h, body, law
            )
            x[PHI] = phi + h * v_mid
            x[PHI_DOT] = v + h * v_dot
            x[THETA] = theta + h * w_mid
            x[THETA_DOT] = w + h * w_dot
            x[BRISTLE] = end

    return inlined(advance, cached=False)


@compiled
def _pendulum_stage(
    phi: float,
    v: float,
    theta: float,
    sine: float,
    cosine: float,
    w: float,
    before: float,
    u: float,
    memory: float,
    h: float,
    body: FurutaPendulum,
    law: FrictionLaw,
) -> tuple[float, float, float]:
    """A stage of the paper's pendulum under any friction law."""
    driven = u - law.parameters.viscous * v
    if HAS_BRISTLE[law.kind]:
        friction, end = bristle_force(v, memory, h, law)
    else:
        free, _ = accelerations_at(v, sine, cosine, w, driven, body)
        pushed, _ = accelerations_at(v, sine, cosine, w, driven + 1.0, body)
        friction = sticking_force(v, before, (before / h + free) / (pushed - free), law)
        end = friction
    v_dot, w_dot = accelerations_at(v, sine, cosine, w, driven - friction, body)
    return v_dot, w_dot, end


_advance = integrator(_pendulum_stage)


@inlined
def advance(
    x: np.ndarray, u: float, dt: float, substeps: int, body: FurutaPendulum, law: FrictionLaw
) -> None:
    """Move the plant's state ``x`` (5,), in place, over ``dt`` [s] with torque ``u`` [V] held."""
    _advance(x, u, dt, substeps, body, law)
