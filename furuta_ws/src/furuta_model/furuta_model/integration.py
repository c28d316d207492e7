r"""One sample of the plant: rigid body (1) and bristle (5) together under constant voltage.

An exponential midpoint rule. Each stage moves the bristle by its exact solution at the stage's
speed and drives the body with the friction's exact mean over that stage; σ₁ż integrates to
σ₁Δz whatever the bristle's rate, so speed never limits the step. The error is of second order
in the substep. What remains explicit is the bristle as a spring and damper between arm and
ground, and the body's rotation; substeps keep the rates of both times the step small.
"""

from __future__ import annotations

from math import ceil, cos, sin, sqrt

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.lugre import LuGre, bristle_after
from furuta_model.pendulum import FurutaPendulum, accelerations_at, rotate
from furuta_model.state import BRISTLE, PHI, PHI_DOT, THETA, THETA_DOT

# Rate of the stuck arm on its bristle times the substep: the midpoint rule is stable below 2.
LARGEST_STEP = 0.25
# Bound of the work per sample: reached only at speeds that no rig survives.
MOST_SUBSTEPS = 10_000


def substeps_for(dt: float, pendulum: FurutaPendulum, friction: LuGre) -> int:
    """Substeps that keep the stuck arm well resolved over a sample of ``dt`` [s]."""
    mobility = pendulum.beta / pendulum.determinant
    spring = sqrt(friction.sigma0 * mobility)
    damper = (friction.sigma1 + friction.viscous) * mobility
    gravity = sqrt(pendulum.alpha * pendulum.delta / pendulum.determinant)
    return max(1, ceil(dt * (spring + damper + gravity) / LARGEST_STEP))


@compiled
def advance(
    x: np.ndarray, u: float, dt: float, substeps: int, body: FurutaPendulum, lugre: LuGre
) -> None:
    """Move the plant's state ``x`` (5,), in place, over ``dt`` [s] with torque ``u`` [V] held."""
    # The body turns a step's angle per step: at high speed that, too, must be small.
    turn = dt * (abs(x[PHI_DOT]) + abs(x[THETA_DOT]))
    if turn > LARGEST_STEP * substeps:
        substeps = ceil(min(turn / LARGEST_STEP, MOST_SUBSTEPS))
    h = dt / substeps
    half = 0.5 * h
    damping_half, damping = lugre.sigma1 / half, lugre.sigma1 / h
    for _ in range(substeps):
        phi, v, theta, w, z = x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT], x[BRISTLE]

        end, mean = bristle_after(v, 0.0, z, half, lugre)
        bristle = lugre.sigma0 * mean + damping_half * (end - z)
        torque = (u - lugre.viscous * v) - bristle
        sine, cosine = sin(theta), cos(theta)
        v_dot, w_dot = accelerations_at(v, sine, cosine, w, torque, body)
        v_mid = v + half * v_dot
        w_mid = w + half * w_dot
        sine, cosine = rotate(sine, cosine, half * w)

        end, mean = bristle_after(v_mid, 0.0, z, h, lugre)
        bristle = lugre.sigma0 * mean + damping * (end - z)
        torque = (u - lugre.viscous * v_mid) - bristle
        v_dot, w_dot = accelerations_at(v_mid, sine, cosine, w_mid, torque, body)
        x[PHI] = phi + h * v_mid
        x[PHI_DOT] = v + h * v_dot
        x[THETA] = theta + h * w_mid
        x[THETA_DOT] = w + h * w_dot
        x[BRISTLE] = end
