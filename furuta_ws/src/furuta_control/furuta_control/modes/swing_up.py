"""Mode ``swing_up``: swings the pendulum up, catches and balances it, in phases.

=========  ===================================  ==========================================
phase      what it does                         ends
=========  ===================================  ==========================================
swinging   energy shaping                       when the pendulum can be caught
tracking   follows the optimised trajectory     the same, or when it deviates
catching   linear-quadratic regulator           near upright: balancing; missed: braking
balancing  as ``balance``, see :func:`design`   after a fall: braking
braking    brings the arm to rest               at rest: swinging or tracking, or off
off        0 V                                  when the state is known
=========  ===================================  ==========================================

Every phase keeps the arm within its travel and speed (:mod:`furuta_control.modes.arm_limits`). A
pendulum that falls after it has been balanced is only swung up again with ``recover``; otherwise it
must be held upright, as in the mode ``balance``. An arm beyond its travel ends the swing-up for
good: only a new start or another mode allows one again.
"""

from __future__ import annotations

from math import ceil
from typing import Annotated, NamedTuple

import numpy as np

from furuta_control.modes import arm_limits, balance, catching, energy_shaping, tracking
from furuta_control.modes.arm_limits import ArmLimits
from furuta_control.modes.balance import Balance
from furuta_control.modes.catching import Catching
from furuta_control.modes.energy_shaping import EnergyShaping
from furuta_control.modes.tracking import Tracking
from furuta_model.compiled import compiled, inlined
from furuta_model.inverse_dynamics import arm_dynamics
from furuta_model.parameters import About
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

OFF, SWINGING, TRACKING, CATCHING, BALANCING, BRAKING = range(6)
PHASES = ("off", "swing_up", "track", "catch", "balance", "brake")

# The mode's memory: the phase; 1 once the pendulum has been balanced; 1 once the arm was beyond its
# travel; samples near upright, or of the trajectory; then that of energy shaping.
PHASE = 0
CAUGHT = 1
BEYOND = 2
SAMPLES = 3
ENERGY = 4
MEMORY = ENERGY + energy_shaping.MEMORY

# Time [s] near upright after which balancing takes over from catching.
SETTLED_TIME = 0.3
# Time constant of the brake and its shortest time [s]; share of the speed at which the arm is at
# rest.
BRAKE_TIME = 0.03
AT_REST = 0.05

NO_TRAJECTORY = (0.0,)


class SwingUpParameters(NamedTuple):
    """Parameters of the mode."""

    recover: Annotated[
        bool, About("swing_up: swing up again after a fall from balance, without a reset")
    ] = False
    torques: Annotated[
        tuple[float, ...],
        About(
            "swing_up: optimised trajectory from hanging at rest: torque u - F at equal intervals; "
            "[0.0]: none, energy shaping alone",
            "V",
            -1e3,
            1e3,
        ),
    ] = NO_TRAJECTORY
    duration: Annotated[float, About("swing_up: time of the trajectory", "s", 1e-2, 100.0)] = 1.0


class SwingUp(NamedTuple):
    """The mode as :func:`command` uses it."""

    recover: bool
    model: FurutaPendulum
    viscous: float
    limits: ArmLimits
    trajectory_limits: ArmLimits
    energy: EnergyShaping
    catching: Catching
    balancing: Balance
    tracking: Tracking
    settled_samples: float
    brake_samples: float


def design(
    p: SwingUpParameters,
    model: FurutaPendulum,
    viscous: float,
    balancing: Balance,
    dt: float,
    used: bool,
    own_gain: bool,
) -> SwingUp:
    """The mode for a rig. If it is not ``used``, nothing that takes time is computed.

    ``viscous`` friction [V s/rad] is known, and compensated beside the friction estimate.
    With ``own_gain`` it balances with the gain with which it catches, not with that of the mode
    ``balance``: poles that suit one rig let another one fall.
    """
    voltage = balancing.voltage_limit
    limits = _limits(model, viscous, balancing, dt)
    regulator, cost = (
        catching.design(model, voltage, limits, balancing.arm_reference)
        if used
        else catching.unused()
    )
    if own_gain:
        balancing = balancing._replace(
            l1=regulator.l1, l2=regulator.l2, l3=regulator.l3, l4=regulator.l4
        )
    trajectory = tracking.unused()
    if used and p.torques != NO_TRAJECTORY:
        deviations = (catching.ARM_DEVIATION * limits.travel, limits.speed)
        trajectory = tracking.design(model, p.torques, p.duration, voltage, deviations, cost, dt)
    return SwingUp(
        p.recover,
        model,
        viscous,
        limits,
        arm_limits.for_trajectory(limits),
        energy_shaping.design(model, voltage, limits),
        regulator,
        balancing,
        trajectory,
        ceil(SETTLED_TIME / dt),
        ceil(BRAKE_TIME / dt),
    )


def is_possible(model: FurutaPendulum, viscous: float, balancing: Balance, dt: float) -> bool:
    """Whether :func:`design` finds a feedback that catches the pendulum."""
    limits = _limits(model, viscous, balancing, dt)
    try:
        regulator, cost = catching.design(
            model, balancing.voltage_limit, limits, balancing.arm_reference
        )
    except (np.linalg.LinAlgError, ArithmeticError, ValueError):
        return False
    return bool(np.all(np.isfinite([*regulator, *cost.flat])))


def _limits(model: FurutaPendulum, viscous: float, balancing: Balance, dt: float) -> ArmLimits:
    return arm_limits.design(
        model,
        balancing.voltage_limit,
        viscous,
        balancing.arm_angle_limit,
        balancing.arm_speed_limit,
        dt,
    )


@inlined
def reset(memory: np.ndarray, at: int) -> None:
    """Forget what has happened: the next sample begins a swing-up."""
    for i in range(MEMORY):
        memory[at + i] = 0.0


@compiled
def command(
    memory: np.ndarray,
    at: int,
    balance_at: int,
    x: np.ndarray,
    friction: float,
    p: SwingUp,
) -> float:
    """Command u [V] for state ``x`` and friction estimate [V]; NaN if the mode does not drive.

    The mode's memory begins at ``at``, that of the mode ``balance`` at ``balance_at``.
    """
    phase = _next_phase(memory, at, balance_at, x, p)
    memory[at + PHASE] = phase
    friction += p.viscous * x[PHI_DOT]
    if phase == OFF:
        return np.nan
    if phase == BALANCING:
        u = balance.command(memory, balance_at, x, friction, p.balancing)
    elif phase == CATCHING:
        u = catching.command(x, friction, p.catching)
    elif phase == TRACKING:
        u = tracking.command(x, memory[at + SAMPLES], friction, p.tracking)
    else:
        u = np.nan
    inertia, torque = arm_dynamics(x[PHI_DOT], x[THETA], x[THETA_DOT], p.model)
    if phase == SWINGING:
        wanted = energy_shaping.acceleration(memory, at + ENERGY, x, p.energy)
    elif phase == BRAKING:
        wanted = -x[PHI_DOT] / BRAKE_TIME
    else:
        wanted = (u - friction - torque) / inertia
    limits = p.trajectory_limits if phase == TRACKING else p.limits
    allowed = arm_limits.limited(wanted, x[PHI], x[PHI_DOT], limits)
    if allowed == wanted and not np.isnan(u):
        return u
    return friction + torque + inertia * allowed


@inlined
def _next_phase(memory: np.ndarray, at: int, balance_at: int, x: np.ndarray, p: SwingUp) -> int:
    """The phase of this sample."""
    if np.isnan(x[PHI] + x[PHI_DOT] + x[THETA] + x[THETA_DOT]):
        balance.leave(memory, balance_at)
        return OFF
    if abs(x[PHI]) > p.limits.last_travel:
        memory[at + BEYOND] = 1.0
    phase = int(memory[at + PHASE])
    if phase == OFF:
        return _begin(memory, at, balance_at, x, p)
    if _lost(phase, memory, balance_at, x, p):
        return _brake(memory, at, balance_at)
    if phase == CATCHING:
        return _hand_over(memory, at, balance_at, x, p)
    return phase if phase == BALANCING else _on_the_way(phase, memory, at, x, p)


@inlined
def _lost(phase: int, memory: np.ndarray, balance_at: int, x: np.ndarray, p: SwingUp) -> bool:
    """Whether the pendulum has fallen, or the arm can no longer be stopped within its limits."""
    if phase == BRAKING:
        return False
    if phase == BALANCING and not balance.balances(memory, balance_at, x, p.balancing):
        return True
    missed = phase == CATCHING and abs(x[THETA]) > catching.MISSED_ANGLE
    return missed or not arm_limits.can_stop(x[PHI], x[PHI_DOT], p.limits)


@inlined
def _on_the_way(phase: int, memory: np.ndarray, at: int, x: np.ndarray, p: SwingUp) -> int:
    """The phase after braking, swinging or tracking."""
    if phase == BRAKING and _still_brakes(memory, at, x, p):
        return BRAKING
    if phase == BRAKING and _given_up(memory, at, p):
        return OFF
    return _swing(memory, at, x, p)


@inlined
def _given_up(memory: np.ndarray, at: int, p: SwingUp) -> bool:
    """Whether the pendulum must not be swung up again."""
    return memory[at + BEYOND] != 0.0 or (memory[at + CAUGHT] != 0.0 and not p.recover)


@inlined
def _begin(memory: np.ndarray, at: int, balance_at: int, x: np.ndarray, p: SwingUp) -> int:
    """The phase after ``off``: the brake, unless only a pendulum held upright will do.

    The brake needs the arm's state only, which is measured. The estimate of the pendulum's speed
    settles meanwhile.
    """
    if not _given_up(memory, at, p):
        return _brake(memory, at, balance_at)
    if memory[at + BEYOND] != 0.0:
        return OFF
    return BALANCING if balance.balances(memory, balance_at, x, p.balancing) else OFF


@inlined
def _swing(memory: np.ndarray, at: int, x: np.ndarray, p: SwingUp) -> int:
    """The phase of a pendulum that is to be swung up."""
    if catching.can_catch(x, p.limits, p.catching):
        memory[at + SAMPLES] = 0.0
        return CATCHING
    if memory[at + PHASE] == TRACKING:
        # The time waits for an arm that does not move yet.
        if memory[at + SAMPLES] > 0.0 or abs(x[PHI_DOT]) > tracking.MOVING:
            memory[at + SAMPLES] += 1.0
        if not tracking.lost(x, memory[at + SAMPLES], p.tracking):
            return TRACKING
    elif tracking.can_start(x, p.tracking):
        memory[at + SAMPLES] = 0.0
        return TRACKING
    if memory[at + PHASE] != SWINGING:
        memory[at + ENERGY + energy_shaping.STARTED] = 0.0
    return SWINGING


@inlined
def _hand_over(memory: np.ndarray, at: int, balance_at: int, x: np.ndarray, p: SwingUp) -> int:
    """Balance once the pendulum has been near upright and slow for long enough."""
    near = (
        abs(x[THETA]) <= p.balancing.catch_angle
        and abs(x[THETA_DOT]) <= p.balancing.catch_speed
        and abs(x[PHI] - p.balancing.arm_reference) <= p.balancing.arm_error_limit
    )
    memory[at + SAMPLES] = memory[at + SAMPLES] + 1.0 if near else 0.0
    if memory[at + SAMPLES] <= p.settled_samples:
        return CATCHING
    balance.leave(memory, balance_at)
    memory[balance_at + balance.BALANCING] = 1.0
    memory[balance_at + balance.FALLEN] = 0.0
    memory[at + CAUGHT] = 1.0
    return BALANCING


@inlined
def _brake(memory: np.ndarray, at: int, balance_at: int) -> int:
    balance.leave(memory, balance_at)
    memory[at + SAMPLES] = 0.0
    return BRAKING


@inlined
def _still_brakes(memory: np.ndarray, at: int, x: np.ndarray, p: SwingUp) -> bool:
    """Whether the arm is not yet at rest, or the estimate may still be settling."""
    memory[at + SAMPLES] += 1.0
    return abs(x[PHI_DOT]) > AT_REST * p.limits.speed or memory[at + SAMPLES] <= p.brake_samples
