"""Mode ``swing_up``: swings the pendulum up, catches and balances it, in phases.

=========  ===================================  ==========================================
phase      what it does                         ends
=========  ===================================  ==========================================
swinging   energy shaping                       when the pendulum can be caught
catching   linear-quadratic regulator           near upright: balancing; missed: braking
balancing  as ``balance``, see :func:`design`   after a fall: braking
braking    brings the arm to rest               at rest: swinging, or off
off        0 V                                  when the state is known
=========  ===================================  ==========================================

Every phase keeps the arm within its travel and speed (:mod:`furuta_control.modes.arm_limits`). A
pendulum that falls after it has been balanced is only swung up again with ``recover``; otherwise it
must be held upright, as in the mode ``balance``. An arm beyond its travel ends the swing-up for
good: only a new start or another mode allows one again.
"""

from dataclasses import dataclass, field
from math import ceil
from typing import Annotated, NamedTuple

import numpy as np

from furuta_control.modes import arm_limits, balance, catching, energy_shaping
from furuta_control.modes.arm_limits import ArmLimits
from furuta_control.modes.balance import Balance, BalanceMemory
from furuta_control.modes.catching import Catching
from furuta_control.modes.energy_shaping import EnergyShaping, EnergyShapingMemory
from furuta_control.modes.mode import (
    BALANCING,
    BRAKING,
    CATCHING,
    OFF,
    SWINGING,
    ControlledRig,
)
from furuta_model.compiled import compiled, inlined
from furuta_model.parameters import About
from furuta_model.pendulum import FurutaPendulum, arm_dynamics
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

# Time [s] near upright after which balancing takes over from catching.
SETTLED_TIME = 0.3
# Time constant of the brake, which is also its shortest time [s].
BRAKE_TIME = 0.03
# Share of the speed limit at which the arm is at rest.
AT_REST = 0.05


class SwingUpParameters(NamedTuple):
    """Parameters of the mode."""

    recover: Annotated[
        bool, About("swing_up: swing up again after a fall from balance, without a reset")
    ] = False


@dataclass
class SwingUpMemory:
    """What the mode remembers.

    Attributes:
        phase: Index in :data:`furuta_control.modes.mode.PHASES`.
        caught: Whether the pendulum has been balanced.
        beyond: Whether the arm has been beyond its travel.
        samples: Samples near upright, or of the brake.
        energy: Memory of energy shaping.
    """

    phase: int = OFF
    caught: bool = False
    beyond: bool = False
    samples: int = 0
    energy: EnergyShapingMemory = field(default_factory=EnergyShapingMemory)


class SwingUp(NamedTuple):
    """The mode as :func:`command` uses it."""

    recover: bool
    model: FurutaPendulum
    viscous: float
    limits: ArmLimits
    energy: EnergyShaping
    catching: Catching
    balancing: Balance
    settled_samples: int
    brake_samples: int


def design(
    rig: ControlledRig,
    p: SwingUpParameters,
    balancing: Balance,
    is_chosen: bool,
    keeps_gain: bool,
) -> SwingUp:
    """The mode for a rig; if another one ``is_chosen``, only what takes no time.

    ``viscous`` friction is known, and compensated beside the friction estimate. Unless it
    ``keeps_gain``, it balances with the gain with which it catches, not with that of the mode
    ``balance``: poles that suit one rig let another one fall.
    """
    of_arm = balancing.parameters
    limits = arm_limits.design(rig, of_arm.arm_angle_limit, of_arm.arm_speed_limit)
    regulator = Catching()
    if is_chosen:
        regulator = catching.design(rig, limits, of_arm.arm_reference)
    return SwingUp(
        recover=p.recover,
        model=rig.model,
        viscous=rig.viscous,
        limits=limits,
        energy=energy_shaping.design(rig, limits),
        catching=regulator,
        balancing=balancing if keeps_gain else balancing._replace(gain=regulator.gain),
        settled_samples=ceil(SETTLED_TIME / rig.sample_time),
        brake_samples=ceil(BRAKE_TIME / rig.sample_time),
    )


@inlined
def reset(memory: SwingUpMemory) -> None:
    """Forget what has happened: the next sample begins a swing-up."""
    memory.phase, memory.samples = OFF, 0
    memory.caught = memory.beyond = memory.energy.started = False


@compiled
def command(
    memory: SwingUpMemory, balancing: BalanceMemory, x: np.ndarray, friction: float, p: SwingUp
) -> float:
    """Command u [V] for state ``x`` and friction estimate [V]; NaN if the mode does not drive."""
    phase = memory.phase = _next_phase(memory, balancing, x, p)
    friction += p.viscous * x[PHI_DOT]
    if phase == OFF:
        return np.nan
    if phase == BALANCING:
        u = balance.command(balancing, x, friction, p.balancing)
    elif phase == CATCHING:
        u = catching.command(x, friction, p.catching)
    else:
        u = np.nan
    inertia, torque = arm_dynamics(x[PHI_DOT], x[THETA], x[THETA_DOT], p.model)
    if phase == SWINGING:
        wanted = energy_shaping.acceleration(memory.energy, x, p.energy)
    elif phase == BRAKING:
        wanted = -x[PHI_DOT] / BRAKE_TIME
    else:
        wanted = (u - friction - torque) / inertia
    allowed = arm_limits.limited(wanted, x[PHI], x[PHI_DOT], p.limits)
    if allowed == wanted and not np.isnan(u):
        return u
    return friction + torque + inertia * allowed


@inlined
def _next_phase(  # noqa: PLR0911 (one for each way on)
    memory: SwingUpMemory, balancing: BalanceMemory, x: np.ndarray, p: SwingUp
) -> int:
    """The phase of this sample.

    ``off`` ends in the brake, unless only a pendulum held upright will do: the brake needs the
    arm's state only, which is measured, and the estimate of the pendulum's speed settles meanwhile.
    """
    if np.isnan(x[PHI] + x[PHI_DOT] + x[THETA] + x[THETA_DOT]):
        balance.leave(balancing)
        return OFF
    if abs(x[PHI]) > p.limits.last_travel:
        memory.beyond = True
    phase, is_over = memory.phase, memory.beyond or (memory.caught and not p.recover)
    if phase == OFF and is_over:
        if memory.beyond:
            return OFF
        return BALANCING if balance.balances(balancing, x, p.balancing) else OFF
    if phase == OFF or _is_lost(phase, balancing, x, p):
        balance.leave(balancing)
        memory.samples = 0
        return BRAKING
    if phase == BALANCING:
        return BALANCING
    if phase == CATCHING:
        memory.samples = memory.samples + 1 if _is_near_upright(x, p) else 0
        if memory.samples <= p.settled_samples:
            return CATCHING
        balance.leave(balancing)
        balance.begin(balancing)
        memory.caught = True
        return BALANCING
    if phase == BRAKING and _still_brakes(memory, x, p):
        return BRAKING
    if phase == BRAKING and is_over:
        return OFF
    if catching.can_catch(x, p.limits, p.catching):
        memory.samples = 0
        return CATCHING
    if phase != SWINGING:
        memory.energy.started = False
    return SWINGING


@inlined
def _is_lost(phase: int, balancing: BalanceMemory, x: np.ndarray, p: SwingUp) -> bool:
    """Whether the pendulum has fallen, or the arm can no longer be stopped within its limits."""
    if phase == BRAKING:
        return False
    if phase == BALANCING and not balance.balances(balancing, x, p.balancing):
        return True
    missed = phase == CATCHING and abs(x[THETA]) > catching.MISSED_ANGLE
    return missed or not arm_limits.can_stop(x[PHI], x[PHI_DOT], p.limits)


@inlined
def _is_near_upright(x: np.ndarray, p: SwingUp) -> bool:
    """Whether the pendulum is upright and slow, with the arm near its reference."""
    limits = p.balancing.parameters
    return (
        abs(x[THETA]) <= limits.catch_angle
        and abs(x[THETA_DOT]) <= limits.catch_speed
        and abs(x[PHI] - limits.arm_reference) <= limits.arm_error_limit
    )


@inlined
def _still_brakes(memory: SwingUpMemory, x: np.ndarray, p: SwingUp) -> bool:
    """Whether the arm is not yet at rest, or the estimate may still be settling."""
    memory.samples += 1
    return abs(x[PHI_DOT]) > AT_REST * p.limits.speed or memory.samples <= p.brake_samples
