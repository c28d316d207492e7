r"""Moves the rig with all its parts over one sample, by the integrator of the plain rig.

The equations are (1) with a torque on the pendulum's joint, cogging, pushes and a friction level
that varies. Coulomb friction of the pendulum truly sticks, as does that of the arm: both torques
are those that bring their joints to rest within the step, as far as the levels allow. If both may
stick, they are found by iteration to the last bits.
"""

from math import pi, sin
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.friction.laws import FrictionLaw, sticking_force
from furuta_model.integration import Point, integrator
from furuta_model.parameters import About
from furuta_model.parts.disturbances import Push, push_torques, wave_torque
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.parts.varied_friction import (
    FrictionVariation,
    keep_springs,
    presliding_force,
    varied,
)
from furuta_model.pendulum import FurutaPendulum, accelerations_at
from furuta_model.state import THETA_DOT

# Most iterations for two sticking joints; the paper's rig needs 24 for all bits.
MOST_ITERATIONS = 200


class PendulumFriction(NamedTuple):
    """Friction in the pendulum's joint."""

    damping: Annotated[float, About("viscous friction", "V s/rad", 0, 10)] = 0.0
    coulomb: Annotated[float, About("Coulomb level", "V", 0, 10)] = 0.0


class Cogging(NamedTuple):
    """Cogging torque -torque sin(periods φ + phase) of the arm's motor."""

    torque: Annotated[float, About("amplitude of the cogging torque", "V", 0, 10)] = 0.0
    periods: Annotated[int, About("periods per turn of the arm", "", 1, 10_000, shape=True)] = 100
    phase: Annotated[float, About("phase at arm angle 0", "rad", -pi, pi, shape=True)] = 0.0


class Body(NamedTuple):
    """The rig in one sample, for the integrator."""

    model: FurutaPendulum
    variation: FrictionVariation
    cogging: Cogging
    pendulum_friction: PendulumFriction
    springs: int
    push: Push
    waves: np.ndarray
    memory: PlantMemory


@inlined
def arm_stage(
    at: Point, start_speed: float, u: float, memory: float, h: float, body: Body, law: FrictionLaw
) -> tuple[float, float, float]:
    """A stage of the integration (:func:`furuta_model.integration.integrator`)."""
    phi, v, sine, cosine, w = at
    model, joint_friction = body.model, body.pendulum_friction
    law = varied(law, phi, body.variation)
    arm, joint = push_torques(phi, sine, cosine, model.delta, body.push)
    torque = u - law.parameters.viscous * v + arm + cogging_torque(phi, body.cogging)
    torque += wave_torque(phi, body.waves)
    joint -= joint_friction.damping * w
    arm_sticks = not law.bristle
    end = 0.0
    if not arm_sticks:
        friction, end = presliding_force(body.memory, v, memory, h, body.springs, law)
        torque -= friction
    v_dot, w_dot = accelerations_at(v, sine, cosine, w, torque, model)
    # Accelerations per torque: (1) has no torque on the joint.
    mobility, coupling, joint_mobility = mobilities(sine, cosine, model)
    v_dot, w_dot = v_dot + coupling * joint, w_dot + joint_mobility * joint
    if not arm_sticks and joint_friction.coulomb == 0.0:
        return v_dot, w_dot, end
    arm_friction, joint_torque = _sticking(
        v,
        start_speed,
        start_speed / h + v_dot,
        body.memory.x[THETA_DOT] / h + w_dot,
        mobility,
        coupling,
        joint_mobility,
        arm_sticks,
        joint_friction.coulomb,
        law,
    )
    v_dot -= mobility * arm_friction + coupling * joint_torque
    w_dot -= coupling * arm_friction + joint_mobility * joint_torque
    return v_dot, w_dot, arm_friction if arm_sticks else end


@compiled
def _sticking(
    v: float,
    start_speed: float,
    arm_rate: float,
    joint_rate: float,
    mobility: float,
    coupling: float,
    joint_mobility: float,
    arm_sticks: bool,
    coulomb: float,
    law: FrictionLaw,
) -> tuple[float, float]:
    """Friction [V] of arm and pendulum: what brings both to rest, as far as the levels allow.

    ``arm_rate`` and ``joint_rate`` [rad/s²] are the decelerations that this takes.
    """
    arm = joint = 0.0
    for _ in range(MOST_ITERATIONS):
        before = arm
        if arm_sticks:
            holding = (arm_rate - coupling * joint) / mobility
            arm = sticking_force(v, start_speed, holding, law)
        if coulomb > 0.0:
            holding = (joint_rate - coupling * arm) / joint_mobility
            joint = min(max(holding, -coulomb), coulomb)
        if arm == before or coulomb == 0.0:
            break
    return arm, joint


@compiled
def mobilities(sine: float, cosine: float, p: FurutaPendulum) -> tuple[float, float, float]:
    """Inverse of the inertia matrix [rad/s²/V]: arm, coupling, pendulum."""
    coupling = p.gamma * cosine
    inertia = p.alpha + p.beta * sine * sine
    scale = 1.0 / (inertia * p.beta - coupling * coupling)
    return p.beta * scale, -coupling * scale, inertia * scale


@compiled
def cogging_torque(phi: float, p: Cogging) -> float:
    """Cogging torque [V] at arm angle φ [rad]."""
    if p.torque == 0.0:
        return 0.0
    return -p.torque * sin(p.periods * phi + p.phase)


@inlined
def _keep(body: Body) -> None:
    keep_springs(body.memory, body.springs)


advance_with_parts = integrator(arm_stage, _keep)
