"""Mode ``swing_up``: swings the pendulum up, catches and balances it. Its phases follow each other:

=========  ===============================================  =====================================
phase      what it does                                     ends
=========  ===============================================  =====================================
swinging   energy shaping                                   when the pendulum can be caught
tracking   the optimised trajectory, if there is one        the same, or when it deviates
catching   linear-quadratic regulator                       near upright: balancing; missed: brake
balancing  the mode ``balance``                             after a fall: brake
braking    brings the arm to rest                           at rest: swinging again, or off
off        0 V                                              when the state is known
=========  ===============================================  =====================================

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
# Time constant of the brake [s], and share of the speed at which the arm counts as at rest.
BRAKE_TIME = 0.03
AT_REST = 0.05

NO_TRAJECTORY = (0.0,)


class SwingUpParameters(NamedTuple):
    """Parameters of the mode."""

    recover: Annotated[
        bool, About("swing_up: swing up again after a fall from balance, without a reset")
    ] = False
    viscous_friction: Annotated[
        float, About("swing_up: viscous friction of the arm, back-EMF included", "V s/rad", 0, 100)
    ] = 0.0
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
    limits: ArmLimits
    energy: EnergyShaping
    catching: Catching
    tracking: Tracking
    settled_samples: float
    sample_time: float


def design(
    p: SwingUpParameters, model: FurutaPendulum, balancing: Balance, dt: float, used: bool
) -> SwingUp:
    """The mode for a rig. If it is not ``used``, nothing that takes time is computed."""
    voltage = balancing.voltage_limit
    limits = arm_limits.design(
        model,
        voltage,
        p.viscous_friction,
        balancing.arm_angle_limit,
        balancing.arm_speed_limit,
        dt,
    )
    regulator, cost = (
        catching.design(model, voltage, limits, balancing.arm_reference)
        if used
        else catching.unused()
    )
    trajectory = tracking.unused()
    if used and p.torques != NO_TRAJECTORY:
        deviations = (catching.ARM_DEVIATION * limits.travel, limits.speed)
        trajectory = tracking.design(model, p.torques, p.duration, voltage, deviations, cost, dt)
    return SwingUp(
        p.recover,
        model,
        limits,
        energy_shaping.design(model, voltage, limits),
        regulator,
        trajectory,
        ceil(SETTLED_TIME / dt),
        dt,
    )


@inlined
def start_anew(memory: np.ndarray, at: int) -> None:
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
    balancing: Balance,
    p: SwingUp,
) -> float:
    """Command u [V] for state ``x`` and friction estimate [V]; NaN if the mode does not drive.

    The mode's memory begins at ``at``, that of the mode ``balance`` at ``balance_at``.
    """
    phase = _next_phase(memory, at, balance_at, x, balancing, p)
    memory[at + PHASE] = phase
    if phase == OFF:
        return np.nan
    if phase == BALANCING:
        u = balance.command(memory, balance_at, x, friction, balancing)
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
    allowed = arm_limits.limited(wanted, x[PHI], x[PHI_DOT], p.limits)
    if allowed == wanted and not np.isnan(u):
        return u
    return friction + torque + inertia * allowed


@inlined
def _next_phase(
    memory: np.ndarray, at: int, balance_at: int, x: np.ndarray, balancing: Balance, p: SwingUp
) -> int:
    """The phase of this sample."""
    if np.isnan(x[PHI] + x[PHI_DOT] + x[THETA] + x[THETA_DOT]):
        balance.leave(memory, balance_at)
        return OFF
    if abs(x[PHI]) > p.limits.last_travel:
        memory[at + BEYOND] = 1.0
    phase = int(memory[at + PHASE])
    in_control = arm_limits.can_stop(x[PHI], x[PHI_DOT], p.limits)
    if phase == OFF:
        return _begin(memory, at, balance_at, x, balancing, p)
    if phase == BALANCING:
        upright = balance.balances(memory, balance_at, x, balancing)
        return BALANCING if upright and in_control else _brake(memory, balance_at)
    if not in_control or (phase == CATCHING and abs(x[THETA]) > catching.MISSED_ANGLE):
        return _brake(memory, balance_at)
    if phase == CATCHING:
        return _hand_over(memory, at, balance_at, x, balancing, p)
    if phase == BRAKING and abs(x[PHI_DOT]) > AT_REST * p.limits.speed:
        return BRAKING
    if phase == BRAKING and _given_up(memory, at, p):
        return OFF
    return _swing(memory, at, x, p)


@inlined
def _given_up(memory: np.ndarray, at: int, p: SwingUp) -> bool:
    """Whether the pendulum must not be swung up again."""
    return memory[at + BEYOND] != 0.0 or (memory[at + CAUGHT] != 0.0 and not p.recover)


@inlined
def _begin(
    memory: np.ndarray, at: int, balance_at: int, x: np.ndarray, balancing: Balance, p: SwingUp
) -> int:
    """The phase after ``off``: one that swings up, unless only a pendulum held upright will do."""
    if balance.balances(memory, balance_at, x, balancing):
        memory[at + CAUGHT] = 1.0
        return BALANCING
    return OFF if _given_up(memory, at, p) else _swing(memory, at, x, p)


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
def _hand_over(
    memory: np.ndarray, at: int, balance_at: int, x: np.ndarray, balancing: Balance, p: SwingUp
) -> int:
    """Balance once the pendulum has been near upright and slow for long enough."""
    near = (
        abs(x[THETA]) <= balancing.catch_angle
        and abs(x[THETA_DOT]) <= balancing.catch_speed
        and abs(x[PHI] - balancing.arm_reference) <= balancing.arm_error_limit
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
def _brake(memory: np.ndarray, balance_at: int) -> int:
    balance.leave(memory, balance_at)
    return BRAKING
