r"""The model that is fitted: (1) with friction in both joints, a tilted base and torque ripple.

If the base is tilted by small angles, the vertical is n = (t_x, t_y, 1) in coordinates of the
base, and the potential is

.. math::
    V = δ(\cosθ + \sinθ(t_y\cosφ - t_x\sinφ))

The motor's torque is u + Σ aₖ cos kφ + bₖ sin kφ. Order 1 is an unbalanced arm on the tilted
base, higher orders are torque ripple of the motor. The arm has LuGre friction. The pendulum's
joint, which never sticks, has c₂θ̇ + f₂ tanh(θ̇/w₀).
"""

from __future__ import annotations

from math import ceil, cos, sin, tanh
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.friction.lugre import bristle_after
from furuta_model.friction.parameters import LuGre
from furuta_model.integration import LARGEST_STEP, substeps_for
from furuta_model.pendulum import FurutaPendulum, accelerations
from furuta_model.state import BRISTLE, PHI, PHI_DOT, THETA, THETA_DOT

# Pendulum speed w₀ [rad/s] over which its joint's Coulomb friction changes its sign.
JOINT_SPEED = 0.05
# Longest integration step [s]: a hundredth of the fastest motion of interest.
LONGEST_STEP = 1e-3
# Shortest step [s]: a model that needs a shorter one does not describe a real rig.
SHORTEST_STEP = 3e-5
NO_RIPPLE = np.zeros((0, 3))


class RigModel(NamedTuple):
    """Parameters of the model.

    ``ripple`` (k, 3): order, cosine and sine amplitude [V] of each wave of the torque.
    """

    body: FurutaPendulum = FurutaPendulum()
    arm: LuGre = LuGre()
    pendulum_viscous: float = 0.0
    pendulum_coulomb: float = 0.0
    tilt_x: float = 0.0
    tilt_y: float = 0.0
    ripple: np.ndarray = NO_RIPPLE


@compiled
def model_accelerations(
    phi: float, v: float, theta: float, w: float, torque: float, m: RigModel
) -> tuple[float, float]:
    """(φ̈, θ̈) [rad/s²]; ``torque`` is u − F of the arm [V]."""
    joint = -m.pendulum_viscous * w
    if m.pendulum_coulomb != 0.0:
        joint -= m.pendulum_coulomb * tanh(w / JOINT_SPEED)
    if m.tilt_x != 0.0 or m.tilt_y != 0.0:
        sine, cosine = sin(phi), cos(phi)
        torque += m.body.delta * sin(theta) * (m.tilt_x * cosine + m.tilt_y * sine)
        joint -= m.body.delta * cos(theta) * (m.tilt_y * cosine - m.tilt_x * sine)
    for k in range(m.ripple.shape[0]):
        order, a, b = m.ripple[k]
        torque += a * cos(order * phi) + b * sin(order * phi)
    v_dot, w_dot = accelerations(v, theta, w, torque, m.body)
    # (1) has no torque on the joint; it acts through the inverse of the inertia matrix.
    s, c = sin(theta), cos(theta)
    inertia = m.body.alpha + m.body.beta * s * s
    coupling = m.body.gamma * c
    determinant = inertia * m.body.beta - coupling * coupling
    return v_dot - coupling * joint / determinant, w_dot + inertia * joint / determinant


@compiled
def move(x: np.ndarray, u: float, dt: float, steps: int, m: RigModel) -> None:
    """Move ``x`` (5,), in place, over ``dt`` [s] under ``u`` [V]: exponential midpoint rule."""
    turn = dt * (abs(x[PHI_DOT]) + abs(x[THETA_DOT]))
    if turn > LARGEST_STEP * steps:
        steps = ceil(min(turn / LARGEST_STEP, 1000.0))
    h = dt / steps
    half = 0.5 * h
    arm = m.arm
    for _ in range(steps):
        phi, v, theta, w, z = x[PHI], x[PHI_DOT], x[THETA], x[THETA_DOT], x[BRISTLE]
        end, mean = bristle_after(v, 0.0, z, half, arm)
        force = arm.sigma0 * mean + arm.sigma1 * (end - z) / half + arm.viscous * v
        v_dot, w_dot = model_accelerations(phi, v, theta, w, u - force, m)
        v_mid = v + half * v_dot
        w_mid = w + half * w_dot
        end, mean = bristle_after(v_mid, 0.0, z, h, arm)
        force = arm.sigma0 * mean + arm.sigma1 * (end - z) / h + arm.viscous * v_mid
        v_dot, w_dot = model_accelerations(
            phi + half * v, v_mid, theta + half * w, w_mid, u - force, m
        )
        x[PHI] = phi + h * v_mid
        x[PHI_DOT] = v + h * v_dot
        x[THETA] = theta + h * w_mid
        x[THETA_DOT] = w + h * w_dot
        x[BRISTLE] = end


def longest_step(m: RigModel) -> float:
    """Integration step [s] that resolves the vibration of a stuck arm on its bristle."""
    resolved = 0.01 / substeps_for(0.01, m.body, m.arm)
    return min(LONGEST_STEP, max(resolved, SHORTEST_STEP))
