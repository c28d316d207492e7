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

from __future__ import annotations

from collections.abc import Callable
from math import ceil, cos, sin, sqrt
from typing import Any

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import (
    HAS_BRISTLE,
    FrictionLaw,
    bristle_force,
    sticking_force,
)
from furuta_model.friction.parameters import LuGre
from furuta_model.pendulum import FurutaPendulum, accelerations_at, rotate
from furuta_model.state import BRISTLE, PHI, PHI_DOT, THETA, THETA_DOT

# Largest rate times substep of the arm stuck on its bristle. The midpoint rule is stable below 2.
LARGEST_STEP = 0.25
# Limits the computing time per sample; reached only at speeds far above those of any rig.
MAX_SUBSTEPS = 10_000

# (φ̈, θ̈) [rad/s²] of a body from φ, φ̇, sin θ, cos θ, θ̇, the torque u − F [V] and the body.
Accelerations = Callable[[float, float, float, float, float, float, Any], tuple[float, float]]


def substeps_for(dt: float, pendulum: FurutaPendulum, friction: LuGre) -> int:
    """Number of substeps that resolve the stuck arm over a sample of ``dt`` [s]."""
    mobility = pendulum.beta / pendulum.determinant
    spring = sqrt(friction.sigma0 * mobility)
    damper = (friction.sigma1 + friction.viscous) * mobility
    gravity = sqrt(pendulum.alpha * pendulum.delta / pendulum.determinant)
    return max(1, ceil(dt * (spring + damper + gravity) / LARGEST_STEP))


def integrator(accelerations: Accelerations) -> Callable[..., None]:
    """Make the midpoint rule for bodies with these ``accelerations`` (compiled).

    The returned function has the arguments of :func:`advance`. It is inlined into its callers.
    """

    def stage_friction(
        phi: float,
        v: float,
        start_speed: float,
        sine: float,
        cosine: float,
        w: float,
        torque: float,
        memory: float,
        h: float,
        body: Any,
        law: FrictionLaw,
    ) -> tuple[float, float]:
        """Mean friction [V] over a stage of ``h`` [s], and the law's memory at its end.

        ``start_speed`` [rad/s] is the arm speed at the start of the substep.
        """
        if HAS_BRISTLE[law.kind]:
            return bristle_force(v, memory, h, law)
        free, _ = accelerations(phi, v, sine, cosine, w, torque, body)
        with_unit_torque, _ = accelerations(phi, v, sine, cosine, w, torque + 1.0, body)
        holding = (start_speed / h + free) / (with_unit_torque - free)
        force = sticking_force(v, start_speed, holding, law)
        return force, force

    stage_friction = compiled(stage_friction, cached=False)

    def advance(
        x: np.ndarray, u: float, dt: float, substeps: int, body: Any, law: FrictionLaw
    ) -> None:
        # The angle by which the body rotates in a substep must be small too.
        angle = dt * (abs(x[PHI_DOT]) + abs(x[THETA_DOT]))
        if angle > LARGEST_STEP * substeps:
            substeps = ceil(min(angle / LARGEST_STEP, MAX_SUBSTEPS))
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
    """Integrate plant state ``x`` (5,) in place over ``dt`` [s] at constant torque ``u`` [V]."""
    _advance(x, u, dt, substeps, body, law)
