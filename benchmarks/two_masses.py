r"""A Furuta pendulum that shares no equation with the simulated plant of the project.

Motor and arm are two masses with a spring, a damper and a gap between them, or one mass. Equations
of motion are those of (1), in the form M(q) q̈ = f(q, q̇) + friction, integrated by Moreau's
midpoint rule: forces at the position in the middle of a step, friction as an inclusion for the
speed at its end (J. J. Moreau, *Unilateral contact and dry friction in finite freedom dynamics*,
1988). So friction with a set of values at rest sticks exactly.

The laws: ``coulomb``, ``stiction`` with a higher level at rest, ``stribeck`` with a level that
falls with the speed - these stick - ``lugre``, ``dahl``, and ``maxwell_slip`` with four springs
that slip one after the other.

The command passes a converter, a delay and a lag. Encoder, tachometer and potentiometer are those
of the paper's rig.
"""

from math import cos, exp, expm1, pi, sin
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import inlined

LAWS = ("coulomb", "stiction", "stribeck", "lugre", "dahl", "maxwell_slip")
COULOMB, STICTION, STRIBECK, LUGRE, DAHL, MAXWELL_SLIP = range(len(LAWS))
# Steps per sample of a rigid and of an elastic rig.
RIGID_STEPS, ELASTIC_STEPS = 10, 20
# Slots of the commands that are under way.
SLOTS = 64
# The state: arm, pendulum, motor, torque of the drive [V], samples so far, and the four springs or
# the bristle [rad] of the friction on the arm, then of that on the motor.
PHI, PHI_DOT, THETA, THETA_DOT, PSI, PSI_DOT, TORQUE, CLOCK, ARM_SPRINGS = range(9)
SPRINGS = 4
MOTOR_SPRINGS = ARM_SPRINGS + SPRINGS
STATES = MOTOR_SPRINGS + SPRINGS
# Smallest level of a bristle [V].
SMALLEST_LEVEL = 1e-12
# The paper's sensors and drive: counts per turn of the encoder, range and noise of tachometer
# [rad/s] and potentiometer [rad], range of the drive [V], codes of each converter.
COUNTS, CODES = 250, 4096
TACHOMETER, POTENTIOMETER, VOLTAGE = 10.0, pi / 4, 10.0
SPEED_NOISE, ANGLE_NOISE = 2.0 * TACHOMETER / CODES, 2.0 * POTENTIOMETER / CODES


class DryFriction(NamedTuple):
    """A friction law: levels [V] forward and backward, what is added at rest [V], and the rest.

    Stribeck velocity [rad/s], stiffness [V/rad] and damping [V s/rad] of the bristle.
    """

    law: int
    forward: float
    backward: float
    added: float
    stribeck_velocity: float
    stiffness: float
    damping: float

    def part(self, share: float) -> "DryFriction":
        """A share of the friction, at the same deflection."""
        return self._replace(
            forward=share * self.forward,
            backward=share * self.backward,
            added=share * self.added,
            stiffness=share * self.stiffness,
            damping=share * self.damping,
        )


class Belt(NamedTuple):
    """What is between motor and arm: frequency [Hz] with the pendulum free in its joint, and more.

    Damping ratio, part of the inertia that is the motor's, whole gap [rad], part of the friction
    that is on the arm, and whether the arm's sensors are on the motor.
    """

    frequency: float
    damping: float
    motor_inertia: float
    gap: float
    arm_friction: float
    senses_motor: bool


class TwoMasses(NamedTuple):
    """The plant as compiled code uses it; delay in steps of ``h`` [s]."""

    alpha: float
    beta: float
    gamma: float
    delta: float
    elastic: bool
    motor_inertia: float
    stiffness: float
    damping: float
    half_gap: float
    senses_motor: bool
    arm_friction: DryFriction
    motor_friction: DryFriction
    h: float
    steps: int
    delay: int
    end_share: float
    mean_share: float


def two_masses(
    body: tuple[float, float, float, float],
    friction: DryFriction,
    belt: Belt | None = None,
    delay: float = 0.0,
    lag: float = 0.0,
    dt: float = 1e-3,
    finer: int = 1,
) -> TwoMasses:
    """A plant with the coefficients α, β, γ, δ of (1), moved over samples of ``dt`` [s].

    Without ``belt`` motor and arm are one. ``delay`` and ``lag`` of the drive in s. ``finer``
    divides the step.
    """
    alpha, beta, gamma, delta = body
    steps = finer * (RIGID_STEPS if belt is None else ELASTIC_STEPS)
    h = dt / steps
    inertia = stiffness = damping = gap = 0.0
    on_arm, on_motor, senses_motor = friction, friction.part(0.0), False
    if belt is not None:
        whole = alpha - gamma**2 / beta
        inertia = belt.motor_inertia * whole
        reduced = inertia * (1.0 - belt.motor_inertia)
        omega = 2.0 * pi * belt.frequency
        stiffness, damping = reduced * omega**2, 2.0 * belt.damping * reduced * omega
        gap, senses_motor = belt.gap, belt.senses_motor
        on_arm, on_motor = friction.part(belt.arm_friction), friction.part(1.0 - belt.arm_friction)
    end_share = -expm1(-h / lag) if lag > 0.0 else 1.0
    return TwoMasses(
        alpha=alpha - inertia,
        beta=beta,
        gamma=gamma,
        delta=delta,
        elastic=belt is not None,
        motor_inertia=inertia,
        stiffness=stiffness,
        damping=damping,
        half_gap=0.5 * gap,
        senses_motor=senses_motor,
        arm_friction=on_arm,
        motor_friction=on_motor,
        h=h,
        steps=steps,
        delay=round(delay / h),
        end_share=end_share,
        mean_share=1.0 - end_share * lag / h if lag > 0.0 else 1.0,
    )


def released(theta: float) -> tuple[np.ndarray, np.ndarray]:
    """State (17,) of a plant at rest whose pendulum is off upright by ``theta`` [rad], commands."""
    x = np.zeros(STATES)
    x[THETA] = theta
    return x, np.zeros(SLOTS)


def longest_delay(dt: float = 1e-3) -> float:
    """The longest delay [s] that the commands under way allow."""
    return (SLOTS - 1) * dt


@inlined
def read_sensors(x: np.ndarray, noise: np.ndarray, p: TwoMasses, measurement: np.ndarray) -> None:
    """Write φ, φ̇ and θ as the sensors show them; ``noise`` (2,) is standard normal."""
    angle, speed = x[PHI], x[PHI_DOT]
    if p.senses_motor:
        angle, speed = x[PSI], x[PSI_DOT]
    measurement[0] = round(angle * COUNTS / (2.0 * pi)) * (2.0 * pi / COUNTS)
    measurement[1] = converted(speed + SPEED_NOISE * noise[0], TACHOMETER)
    measurement[2] = converted(x[THETA] + ANGLE_NOISE * noise[1], POTENTIOMETER)
    measurement[3] = np.nan


@inlined
def converted(value: float, full_scale: float) -> float:
    """A value through a converter of ± ``full_scale``, which clips at its highest code."""
    code = round(value * (CODES / 2) / full_scale)
    return min(max(code, -CODES // 2), CODES // 2 - 1) * full_scale / (CODES / 2)


@inlined
def move_plant(x: np.ndarray, sent: np.ndarray, voltage: float, p: TwoMasses) -> None:
    """Move over a sample, at whose beginning the drive is given ``voltage`` [V]."""
    sample = int(x[CLOCK])
    sent[sample % SLOTS] = voltage
    for i in range(p.steps):
        due = sample * p.steps + i - p.delay
        _step(x, sent[(due // p.steps) % SLOTS] if due >= 0 else 0.0, p)
    x[CLOCK] += 1.0


@inlined
def _step(x: np.ndarray, voltage: float, p: TwoMasses) -> None:
    """Moreau's midpoint rule over ``h``."""
    h, half = p.h, 0.5 * p.h
    torque = x[TORQUE] + p.mean_share * (voltage - x[TORQUE])
    x[TORQUE] += p.end_share * (voltage - x[TORQUE])
    v, w = x[PHI_DOT], x[THETA_DOT]
    x[PHI] += half * v
    x[THETA] += half * w
    if p.elastic:
        x[PSI] += half * x[PSI_DOT]
        passed = _belt_torque(x[PSI] - x[PHI], x[PSI_DOT] - v, p)
        gain = 1.0 / p.motor_inertia
        free = x[PSI_DOT] + h * gain * (torque - passed)
        force, sticks = _friction(x, MOTOR_SPRINGS, x[PSI_DOT], free, gain, h, p.motor_friction)
        x[PSI_DOT] = 0.0 if sticks else free - h * gain * force
        x[PSI] += half * x[PSI_DOT]
        torque = passed
    s, c = sin(x[THETA]), cos(x[THETA])
    m11, m12, m22 = p.alpha + p.beta * s * s, p.gamma * c, p.beta
    f1 = torque + p.gamma * s * w * w - 2.0 * p.beta * c * s * v * w
    f2 = p.beta * c * s * v * v + p.delta * s
    determinant = m11 * m22 - m12 * m12
    free = v + h * (m22 * f1 - m12 * f2) / determinant
    gain = m22 / determinant
    force, sticks = _friction(x, ARM_SPRINGS, v, free, gain, h, p.arm_friction)
    x[PHI_DOT] = 0.0 if sticks else free - h * gain * force
    x[THETA_DOT] += h * (m11 * f2 - m12 * (f1 - force)) / determinant
    x[PHI] += half * x[PHI_DOT]
    x[THETA] += half * x[THETA_DOT]


@inlined
def _belt_torque(twist: float, rate: float, p: TwoMasses) -> float:
    """Torque [V] on the arm; a belt with a gap only pushes."""
    if p.half_gap == 0.0:
        return p.stiffness * twist + p.damping * rate
    if twist > p.half_gap:
        return max(p.stiffness * (twist - p.half_gap) + p.damping * rate, 0.0)
    if twist < -p.half_gap:
        return min(p.stiffness * (twist + p.half_gap) + p.damping * rate, 0.0)
    return 0.0


@inlined
def _friction(
    x: np.ndarray, first: int, v: float, free: float, gain: float, h: float, p: DryFriction
) -> tuple[float, bool]:
    """Friction [V] over a step from speed ``v``, and whether the mass sticks.

    ``free`` [rad/s] is the speed at its end without friction, which F reduces by h · ``gain`` · F.
    """
    if p.law <= STRIBECK:
        return _set_valued(v, free / (gain * h), p)
    level = p.forward if v > 0.0 else p.backward
    if p.law == MAXWELL_SLIP:
        force, stiffness = 0.0, p.stiffness / SPRINGS
        for k in range(SPRINGS):
            # The springs slip at 1, 2, 3 and 4 tenths of the level.
            longest = 0.1 * (k + 1) * level / max(stiffness, SMALLEST_LEVEL)
            x[first + k] = min(max(x[first + k] + h * v, -longest), longest)
            force += stiffness * x[first + k]
        return force, False
    if p.law == LUGRE:
        level += p.added * exp(-((v / p.stribeck_velocity) ** 2))
    z = x[first]
    x[first] = (z + h * v) / (1.0 + h * p.stiffness * abs(v) / max(level, SMALLEST_LEVEL))
    damping = p.damping if p.law == LUGRE else 0.0
    return p.stiffness * x[first] + damping * (x[first] - z) / h, False


@inlined
def _set_valued(v: float, holding: float, p: DryFriction) -> tuple[float, bool]:
    """The friction of a law with a set of values at rest; ``holding`` [V] would stop the mass."""
    level = p.forward if holding > 0.0 else p.backward
    sliding = level
    if p.law == STRIBECK:
        sliding += p.added * exp(-((v / p.stribeck_velocity) ** 2))
    passes_rest = v * holding <= 0.0
    most = level + (p.added if p.law != COULOMB else 0.0) if passes_rest else sliding
    if abs(holding) <= most:
        return holding, True
    return (sliding if holding > 0.0 else -sliding), False
