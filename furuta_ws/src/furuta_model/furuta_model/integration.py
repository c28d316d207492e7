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

# (φ̈, θ̈) [rad/s²] of a body, given φ, φ̇, sin θ, cos θ, θ̇, the torque u − F [V] and the body.
Accelerations = Callable[[float, float, float, float, float, float, Any], tuple[float, float]]


def substeps_for(dt: float, pendulum: FurutaPendulum, friction: LuGre) -> int:
    """Substeps that keep the stuck arm well resolved over a sample of ``dt`` [s]."""
    mobility = pendulum.beta / pendulum.determinant
    spring = sqrt(friction.sigma0 * mobility)
    damper = (friction.sigma1 + friction.viscous) * mobility
    gravity = sqrt(pendulum.alpha * pendulum.delta / pendulum.determinant)
    return max(1, ceil(dt * (spring + damper + gravity) / LARGEST_STEP))


def integrator(accelerations: Accelerations) -> Callable[..., None]:
    """The midpoint rule for bodies with these ``accelerations`` (compiled).

    The function made has the arguments of :func:`advance`. It is compiled into its callers.
    """

    def stage_friction(
        phi: float,
        v: float,
        before: float,
        sine: float,
        cosine: float,
        w: float,
        torque: float,
        memory: float,
        h: float,
        body: Any,
        law: FrictionLaw,
    ) -> tuple[float, float]:
        """Mean friction [V] over a stage of ``h`` [s], and the law's memory at its end."""
        if HAS_BRISTLE[law.kind]:
            return bristle_force(v, memory, h, law)
        free, _ = accelerations(phi, v, sine, cosine, w, torque, body)
        pushed, _ = accelerations(phi, v, sine, cosine, w, torque + 1.0, body)
        force = sticking_force(v, before, (before / h + free) / (pushed - free), law)
        return force, force

    stage_friction = compiled(stage_friction, cached=False)

    def advance(
        x: np.ndarray, u: float, dt: float, substeps: int, body: Any, law: FrictionLaw
    ) -> None:
        # The body turns by an angle in each step: at high speed that, too, must be small.
        turn = dt * (abs(x[PHI_DOT]) + abs(x[THETA_DOT]))
        if turn > LARGEST_STEP * substeps:
            substeps = ceil(min(turn / LARGEST_STEP, MOST_SUBSTEPS))
        h = dt / substeps
        half = 0.5 * h
        viscous = law.parameters.viscous
        for _ in range(substeps):
            phi, v, theta, w, memory = x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT], x[BRISTLE]

            sine, cosine = sin(theta), cos(theta)
            driven = u - viscous * v
            friction, _ = stage_friction(
                phi, v, v, sine, cosine, w, driven, memory, half, body, law
            )
            v_dot, w_dot = accelerations(phi, v, sine, cosine, w, driven - friction, body)
            phi_mid = phi + half * v
            v_mid = v + half * v_dot
            w_mid = w + half * w_dot
            sine, cosine = rotate(sine, cosine, half * w)

            driven = u - viscous * v_mid
            friction, end = stage_friction(
                phi_mid, v_mid, v, sine, cosine, w_mid, driven, memory, h, body, law
            )
            v_dot, w_dot = accelerations(
                phi_mid, v_mid, sine, cosine, w_mid, driven - friction, body
            )
            x[PHI] = phi + h * v_mid
            x[PHI_DOT] = v + h * v_dot
            x[THETA] = theta + h * w_mid
            x[THETA_DOT] = w + h * w_dot
            x[BRISTLE] = end

    return inlined(advance, cached=False)


@compiled
def _pendulum_accelerations(
    phi: float, v: float, sine: float, cosine: float, w: float, torque: float, body: FurutaPendulum
) -> tuple[float, float]:
    return accelerations_at(v, sine, cosine, w, torque, body)


_advance = integrator(_pendulum_accelerations)


@inlined
def advance(
    x: np.ndarray, u: float, dt: float, substeps: int, body: FurutaPendulum, law: FrictionLaw
) -> None:
    """Move the plant's state ``x`` (5,), in place, over ``dt`` [s] with torque ``u`` [V] held."""
    _advance(x, u, dt, substeps, body, law)
