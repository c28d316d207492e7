r"""The model that is fitted: the simulated rig's equations with smooth friction in the joint.

Body, LuGre friction, tilt, waves of the torque and integrator are those of the simulation
(:mod:`furuta_model.parts.motion`). Two things differ. The Coulomb friction of the pendulum's joint
is f tanh(θ̇/w₀), because a joint that truly sticks forgets its speed, and with it how the motion
depends on the parameters. And the arm's Coulomb level may grow with the motor's torque, as in a
gear: α₀ + l|u|.
"""

from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import tanh
from furuta_model.friction.laws import LAWS, FrictionLaw, bristle_force
from furuta_model.friction.parameters import Friction
from furuta_model.integration import integrator, substeps_for
from furuta_model.parts.motion import PendulumFriction, mobilities
from furuta_model.parts.pushes import Push, push_torques
from furuta_model.parts.tilt import Tilt, with_tilt
from furuta_model.parts.torque_waves import wave_torque
from furuta_model.pendulum import FurutaPendulum, accelerations_at

# Pendulum speed w₀ [rad/s] over which its joint's Coulomb friction changes its sign.
JOINT_SPEED = 0.05
# Longest integration step [s]: a hundredth of the fastest motion of interest.
LONGEST_STEP = 1e-3
# Shortest step [s]: a model that needs a shorter one does not describe a real rig.
SHORTEST_STEP = 3e-5
LUGRE = LAWS.index("lugre")


class RigModel(NamedTuple):
    """Parameters of the model.

    ``waves`` (k, 3): order, cosine and sine amplitude [V] of each wave of the torque. ``load``:
    increase of the Coulomb level with the motor's torque [V/V].
    """

    body: FurutaPendulum
    friction: Friction
    pendulum_friction: PendulumFriction
    tilt: Tilt
    waves: np.ndarray
    load: float


@inlined
def rig_accelerations(
    phi: float, v: float, sine: float, cosine: float, w: float, torque: float, rig: RigModel
) -> tuple[float, float]:
    """(φ̈, θ̈) [rad/s²]; ``torque`` is u − F of the arm [V], sine and cosine are those of θ."""
    tilted = with_tilt(Push(0.0, 0.0, 0.0, 0.0), rig.tilt)
    arm, joint = push_torques(phi, sine, cosine, rig.body.delta, tilted)
    joint -= rig.pendulum_friction.damping * w
    if rig.pendulum_friction.coulomb != 0.0:
        joint -= rig.pendulum_friction.coulomb * tanh(w / JOINT_SPEED)
    torque += arm + wave_torque(phi, rig.waves)
    v_dot, w_dot = accelerations_at(v, sine, cosine, w, torque, rig.body)
    # (1) has no torque on the joint; it acts through the inverse of the inertia matrix.
    _, coupling, joint_mobility = mobilities(sine, cosine, rig.body)
    return v_dot + coupling * joint, w_dot + joint_mobility * joint


@inlined
def _stage(
    phi: float,
    v: float,
    theta: float,
    sine: float,
    cosine: float,
    w: float,
    start_speed: float,
    u: float,
    memory: float,
    h: float,
    rig: RigModel,
    law: FrictionLaw,
) -> tuple[float, float, float]:
    """A stage of the integration (:func:`furuta_model.integration.integrator`)."""
    friction, end = bristle_force(v, memory, h, law)
    torque = u - law.parameters.viscous * v - friction
    v_dot, w_dot = rig_accelerations(phi, v, sine, cosine, w, torque, rig)
    return v_dot, w_dot, end


_advance = integrator(_stage)


@compiled
def move(x: np.ndarray, u: float, dt: float, steps: int, rig: RigModel) -> None:
    """Move ``x`` (5,), in place, over ``dt`` [s] under ``u`` [V] by the plant's integrator."""
    _advance(x, u, dt, steps, rig, FrictionLaw(LUGRE, _loaded(rig.friction, rig.load * abs(u))))


@compiled
def _loaded(p: Friction, more: float) -> Friction:
    """Friction with a Coulomb level that is higher by ``more`` [V]."""
    return Friction(
        p.sigma0, p.sigma1, p.alpha0 + more, p.alpha1, p.stribeck_velocity, p.viscous, p.asymmetry
    )


def longest_step(rig: RigModel) -> float:
    """Integration step [s] that resolves the vibration of a stuck arm on its bristle."""
    resolved = 0.01 / substeps_for(0.01, rig.body, rig.friction)
    return min(LONGEST_STEP, max(resolved, SHORTEST_STEP))
