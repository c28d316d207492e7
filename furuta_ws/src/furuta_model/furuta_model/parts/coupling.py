r"""Elastic coupling with backlash between motor and arm: belt, gear or harmonic drive.

The arm's inertia without the pendulum's reaction, J = α − γ²/β, is split into that of the motor,
:math:`J_m = fJ`, and that of the arm, :math:`J_a = (1 - f)J`. With the twist d = ψ − φ of the
motor's angle ψ against the arm's, the coupling transmits

.. math::
    τ = k\,(d \mp b/2) + c\,\dot d \text{ for } |d| > b/2, \qquad 0 \text{ otherwise}, \qquad
    k = μω^2, \quad c = 2ζμω, \quad μ = \frac{J_m J_a}{J}

ω is the natural frequency while the pendulum is free in its joint and the gap b is closed. A closed
gap only pushes. Friction acts on the motor, on the arm or, in parts, on both.

Both move by the integrator of the plain rig. Each stage of the midpoint rule takes the coupling's
torque at its state, for the arm with all its parts (:mod:`furuta_model.parts.motion`) and for the
motor with its part of the friction.
"""

from math import ceil, pi, sqrt
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.elementary import sin_cos
from furuta_model.friction.laws import FrictionLaw, sticking_force
from furuta_model.friction.parameters import Friction
from furuta_model.integration import first_half_rule, sufficient_substeps, whole_rule
from furuta_model.parameters import About, ParameterError
from furuta_model.parts.motion import Body, Cogging, arm_stage, cogging_torque
from furuta_model.parts.plant_memory import MotorMemory
from furuta_model.parts.varied_friction import keep_springs, presliding_force, varied
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI, PHI_DOT, THETA

SIDES = ("arm", "motor")
# Largest angle of the coupling's vibration [rad], and of a bristle's, in a substep. The error of
# the midpoint rule is then below 1e-6 rad in a second.
LARGEST_PHASE, LARGEST_BRISTLE_STEP = 0.02, 0.1
# Smallest substep before a contact, relative to the largest.
SMALLEST_STEP = 1e-3


class Coupling(NamedTuple):
    """The coupling of motor and arm. It is rigid with frequency 0."""

    frequency: Annotated[
        float, About("frequency of the vibration, 0 for a rigid arm", "Hz", 0, 1000)
    ] = 0.0
    damping: Annotated[float, About("damping ratio of the vibration", "", 0, 1, shape=True)] = 0.03
    motor_inertia: Annotated[
        float,
        About(
            "part of the inertia alpha - gamma²/beta that belongs to the motor",
            "",
            0.02,
            0.98,
            shape=True,
        ),
    ] = 0.5
    backlash: Annotated[float, About("whole gap of the coupling", "rad", 0, 1)] = 0.0
    arm_friction: Annotated[
        float,
        About("part of the friction on the arm; the rest is on the motor", "", 0, 1, shape=True),
    ] = 0.0
    sensors: Annotated[
        str, About("side on which encoder and tachometer are", choices=SIDES, shape=True)
    ] = "arm"

    @property
    def is_elastic(self) -> bool:
        """Whether motor and arm are two masses."""
        return self.frequency > 0.0

    @property
    def senses_motor(self) -> bool:
        """Whether the arm's sensors see the motor instead of the arm."""
        return self.is_elastic and self.sensors == "motor"

    def check(self) -> None:
        """Reject a gap in a rigid coupling."""
        if self.backlash > 0.0 and not self.is_elastic:
            raise ParameterError(
                "coupling.backlash needs coupling.frequency above 0, given a backlash of "
                f"{self.backlash:g} rad and frequency 0"
            )


class ElasticRig(NamedTuple):
    """Arm and motor, as compiled code uses them; the arm without the motor is ``arm``.

    Inertia of the motor [V s²/rad], stiffness [V/rad], damping [V s/rad], half the gap [rad].
    """

    on: bool
    substeps: int
    arm: FurutaPendulum
    inertia: float
    stiffness: float
    damping: float
    half_gap: float
    arm_friction: FrictionLaw
    motor_friction: FrictionLaw


def design_coupling(
    p: Coupling, model: FurutaPendulum, law: FrictionLaw, sample_time: float
) -> ElasticRig:
    """The two masses, with the number of integration steps that they need."""
    whole = model.determinant / model.beta
    inertia = p.motor_inertia * whole
    reduced = inertia * (1.0 - p.motor_inertia)
    omega = 2.0 * pi * p.frequency
    arm_friction = scaled_law(law, p.arm_friction)
    motor_friction = scaled_law(law, 1.0 - p.arm_friction)
    rates = [
        _bristle_rate(arm_friction.parameters, whole - inertia),
        _bristle_rate(motor_friction.parameters, inertia),
    ]
    return ElasticRig(
        on=p.is_elastic,
        substeps=ceil(
            sample_time * max(omega / LARGEST_PHASE, max(rates) / LARGEST_BRISTLE_STEP, 1.0)
        ),
        arm=model._replace(alpha=model.alpha - inertia),
        inertia=inertia,
        stiffness=reduced * omega * omega,
        damping=2.0 * p.damping * reduced * omega,
        half_gap=0.5 * p.backlash,
        arm_friction=arm_friction,
        motor_friction=motor_friction,
    )


def scaled_law(law: FrictionLaw, factor: float) -> FrictionLaw:
    """The law with a part of its force at the same deflection."""
    p = law.parameters
    return law._replace(
        parameters=p._replace(
            sigma0=factor * p.sigma0,
            sigma1=factor * p.sigma1,
            alpha0=factor * p.alpha0,
            alpha1=factor * p.alpha1,
            viscous=factor * p.viscous,
        )
    )


def _bristle_rate(friction: Friction, inertia: float) -> float:
    """Rate [1/s] of an inertia [V s²/rad] that is stuck on its bristle."""
    return sqrt(friction.sigma0 / inertia) + (friction.sigma1 + friction.viscous) / inertia


@inlined
def coupling_torque(twist: float, twist_rate: float, p: ElasticRig) -> float:
    """Torque [V] on the arm at a twist [rad] of the motor against it, and its rate [rad/s]."""
    if twist > p.half_gap:
        torque = p.stiffness * (twist - p.half_gap) + p.damping * twist_rate
        return torque if p.half_gap == 0.0 else max(torque, 0.0)
    if twist < -p.half_gap:
        torque = p.stiffness * (twist + p.half_gap) + p.damping * twist_rate
        return torque if p.half_gap == 0.0 else min(torque, 0.0)
    return p.damping * twist_rate if p.half_gap == 0.0 else 0.0


@inlined
def step_to_contact(twist: float, twist_rate: float, largest: float, p: ElasticRig) -> float:
    """Length of the next substep [s]: it ends where the gap closes, as the torque jumps there."""
    if abs(twist) >= p.half_gap or twist_rate == 0.0:
        return largest
    edge = p.half_gap if twist_rate > 0.0 else -p.half_gap
    return min(max((edge - twist) / twist_rate, SMALLEST_STEP * largest), largest)


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
    law = varied(p.motor_friction, angle, body.variation)
    torque -= law.parameters.viscous * v
    if law.bristle:
        friction, end = presliding_force(motor, v, motor.bristle, h, body.springs, law)
    else:
        holding = p.inertia * motor.speed / h + torque
        friction = sticking_force(v, motor.speed, holding, law)
        end = friction
    return (torque - friction) / p.inertia, end
