r"""The model that is fitted: (1) with friction in both joints, a tilted base and torque ripple.

If the base is tilted by small angles, the vertical is n = (t_x, t_y, 1) in coordinates of the
base, and the potential is

.. math::
    V = δ(\cosθ + \sinθ(t_y\cosφ - t_x\sinφ))

The motor's torque is u + Σ aₖ cos kφ + bₖ sin kφ. Order 1 is an unbalanced arm on the tilted
base, higher orders are torque ripple of the motor. The arm has LuGre friction. The pendulum's
joint, which never sticks, has c₂θ̇ + f₂ tanh(θ̇/w₀). The arm's Coulomb level may grow with the
motor's torque, as in a gear: α₀ + l|u|.
"""

from __future__ import annotations

from math import cos, sin, tanh
from typing import NamedTuple

import numpy as np

from furuta_identification.shooting.bristle import bristle_after
from furuta_model.compiled import compiled
from furuta_model.friction.laws import LAWS, FrictionLaw
from furuta_model.friction.parameters import Friction
from furuta_model.integration import integrator, substeps_for
from furuta_model.pendulum import FurutaPendulum, accelerations

# Pendulum speed w₀ [rad/s] over which its joint's Coulomb friction changes its sign.
JOINT_SPEED = 0.05
# Longest integration step [s]: a hundredth of the fastest motion of interest.
LONGEST_STEP = 1e-3
# Shortest step [s]: a model that needs a shorter one does not describe a real rig.
SHORTEST_STEP = 3e-5
NO_RIPPLE = np.zeros((0, 3))
LUGRE = LAWS.index("lugre")


class RigModel(NamedTuple):
    """Parameters of the model.

    ``ripple`` (k, 3): order, cosine and sine amplitude [V] of each wave of the torque. ``load``:
    increase of the Coulomb level with the motor's torque [V/V].
    """

    body: FurutaPendulum = FurutaPendulum()
    arm: Friction = Friction()
    pendulum_viscous: float = 0.0
    pendulum_coulomb: float = 0.0
    tilt_x: float = 0.0
    tilt_y: float = 0.0
    ripple: np.ndarray = NO_RIPPLE
    load: float = 0.0


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
def _stage(
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
    m: RigModel,
    law: FrictionLaw,
) -> tuple[float, float, float]:
    """A stage of the integration (:func:`furuta_model.integration.integrator`)."""
    arm = law.parameters
    end, mean = bristle_after(v, memory, h, arm)
    force = arm.sigma0 * mean + arm.sigma1 * (end - memory) / h + arm.viscous * v
    v_dot, w_dot = model_accelerations(phi, v, theta, w, u - force, m)
    return v_dot, w_dot, end


_advance = integrator(_stage)


@compiled
def move(x: np.ndarray, u: float, dt: float, steps: int, m: RigModel) -> None:
    """Move ``x`` (5,), in place, over ``dt`` [s] under ``u`` [V] by the plant's integrator."""
    _advance(x, u, dt, steps, m, FrictionLaw(LUGRE, _loaded(m.arm, m.load * abs(u))))


@compiled
def _loaded(p: Friction, more: float) -> Friction:
    """Friction with a Coulomb level that is higher by ``more`` [V]."""
    return Friction(
        p.sigma0, p.sigma1, p.alpha0 + more, p.alpha1, p.stribeck_velocity, p.viscous, p.asymmetry
    )


def longest_step(m: RigModel) -> float:
    """Integration step [s] that resolves the vibration of a stuck arm on its bristle."""
    resolved = 0.01 / substeps_for(0.01, m.body, m.arm)
    return min(LONGEST_STEP, max(resolved, SHORTEST_STEP))
