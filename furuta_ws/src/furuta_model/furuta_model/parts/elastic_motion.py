"""Moves motor and arm with an elastic coupling over one sample, by the integrator of the plain rig.

Each stage of the midpoint rule takes the coupling's torque at its state, for the arm with all its
parts (:mod:`furuta_model.parts.motion`) and for the motor with its part of the friction.
"""

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.elementary import sin_cos
from furuta_model.friction.laws import (
    HAS_BRISTLE,
    HAS_SPRINGS,
    FrictionLaw,
    bristle_force,
    friction_force,
    sticking_force,
)
from furuta_model.integration import first_half_rule, sufficient_substeps, whole_rule
from furuta_model.parts.coupling import SMALLEST_STEP, ElasticRig, coupling_torque, step_to_contact
from furuta_model.parts.friction_variation import FrictionVariation, varied
from furuta_model.parts.motion import Body, Cogging, arm_stage, cogging_torque
from furuta_model.parts.plant_memory import MotorMemory, PlantMemory
from furuta_model.parts.springs import keep_springs, springs_force, springs_friction
from furuta_model.state import PHI, PHI_DOT, THETA

_arm_half, _arm_whole = first_half_rule(arm_stage), whole_rule(arm_stage)


@inlined
def advance_elastic(x: np.ndarray, u: float, dt: float, rig: Body, p: ElasticRig) -> None:
    """Integrate arm ``x`` (5,) and motor in place over ``dt`` [s] at constant ``u`` [V].

    ``rig`` is as if they were one; cogging acts on the motor.
    """
    motor = rig.memory.motor
    body = Body(
        model=p.arm,
        variation=rig.variation,
        cogging=Cogging(0.0, 1, 0.0),
        pendulum_friction=rig.pendulum_friction,
        springs=rig.springs,
        push=rig.push,
        waves=rig.waves,
        memory=rig.memory,
    )
    largest = dt / sufficient_substeps(x, dt, p.substeps)
    left = dt
    while left > 0.0:
        h = min(step_to_contact(motor.angle - x[PHI], motor.speed - x[PHI_DOT], largest, p), left)
        left = left - h if left - h > SMALLEST_STEP * largest else 0.0
        _substep(x, u, h, body, rig.cogging, p)
        keep_springs(body.memory, body.springs)
        keep_springs(motor, body.springs)


@inlined
def _substep(
    x: np.ndarray, u: float, h: float, body: Body, cogging: Cogging, p: ElasticRig
) -> None:
    """Integrate over ``h`` [s]."""
    motor, half = body.memory.motor, 0.5 * h
    sine, cosine = sin_cos(x[THETA])
    angle, speed = motor.angle, motor.speed
    torque = coupling_torque(angle - x[PHI], speed - x[PHI_DOT], p)
    free = u - torque + cogging_torque(angle, cogging)
    rate, _ = _motor_stage(motor, angle, speed, free, half, body, p)
    speed_mid = speed + half * rate
    v_mid, w_mid = _arm_half(x, torque, h, sine, cosine, body, p.arm_friction)
    angle_mid, phi_mid = angle + half * speed, x[PHI] + half * x[PHI_DOT]
    torque = coupling_torque(angle_mid - phi_mid, speed_mid - v_mid, p)
    free = u - torque + cogging_torque(angle_mid, cogging)
    rate, motor.bristle = _motor_stage(motor, angle_mid, speed_mid, free, h, body, p)
    _arm_whole(x, torque, h, sine, cosine, v_mid, w_mid, body, p.arm_friction)
    motor.angle, motor.speed = angle + h * speed_mid, speed + h * rate


@inlined
def _motor_stage(
    motor: MotorMemory, angle: float, v: float, torque: float, h: float, body: Body, p: ElasticRig
) -> tuple[float, float]:
    """Acceleration [rad/s²] at speed v, and the law's memory after ``h`` [s]."""
    law = _motor_law(body.memory, angle, body.variation, p)
    torque -= law.parameters.viscous * v
    if HAS_SPRINGS[law.kind]:
        friction, end = springs_force(motor, v, h, body.springs, law)
    elif HAS_BRISTLE[law.kind]:
        friction, end = bristle_force(v, motor.bristle, h, law)
    else:
        holding = p.inertia * motor.speed / h + torque
        friction = sticking_force(v, motor.speed, holding, law)
        end = friction
    return (torque - friction) / p.inertia, end


@inlined
def _motor_law(
    memory: PlantMemory, angle: float, variation: FrictionVariation, p: ElasticRig
) -> FrictionLaw:
    return varied(p.motor_friction, angle, memory.level_change, variation)


@inlined
def motor_friction(
    memory: PlantMemory, springs: int, variation: FrictionVariation, p: ElasticRig
) -> float:
    """Friction [V] of the motor, with viscous part."""
    motor = memory.motor
    law = _motor_law(memory, motor.angle, variation, p)
    if HAS_SPRINGS[law.kind]:
        force = springs_friction(motor, motor.speed, springs, law)
        return force + law.parameters.viscous * motor.speed
    return friction_force(motor.speed, motor.bristle, law)
