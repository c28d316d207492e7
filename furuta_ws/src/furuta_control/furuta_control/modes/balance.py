"""Mode ``balance``: state feedback about upright with friction compensation, eqs. (6) to (8).

Sign convention of the whole workspace: (1) has u − F on its right side, with F > 0 if friction
opposes positive arm speed. The estimate F̂ is therefore *added*:

    u = −Lx + F̂

The scan of the paper has a minus in (8), which would double the friction.

The arm's error φ − reference is limited before it is fed back. An arm that is far away then returns
at a limited speed, and the pendulum keeps enough of the voltage. For any gain on the error between
0 and L₁ the loop with the paper's gain is stable. Two rivals of friction compensation are options:
integral action on that error, and :mod:`furuta_control.modes.super_twisting`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_control.modes import super_twisting
from furuta_control.modes.super_twisting import SuperTwisting
from furuta_model.compiled import inlined
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

# The mode's memory: 1 while the pendulum is balanced; 1 after it has fallen, until it is caught;
# samples for which it has been ready to be caught; integral of the arm's error over the integral
# time [rad]; then that of super-twisting.
BALANCING = 0
FALLEN = 1
READY = 2
INTEGRAL = 3
TWISTING = 4
MEMORY = TWISTING + super_twisting.MEMORY


class Balance(NamedTuple):
    """Gain L of u = −Lx [V per unit of state], and when balancing stops and starts.

    Angles [rad], speeds [rad/s], number of samples. ``integral_share`` is the sample time over the
    integral time, 0 without integral action; ``voltage_limit`` [V] is that of the command.
    """

    l1: float
    l2: float
    l3: float
    l4: float
    fall_angle: float
    arm_angle_limit: float
    arm_speed_limit: float
    catch_angle: float
    catch_speed: float
    catch_samples: float
    arm_reference: float
    arm_error_limit: float
    integral_share: float
    super_twisting: SuperTwisting
    voltage_limit: float


@inlined
def balances(memory: np.ndarray, at: int, x: np.ndarray, p: Balance) -> bool:
    """Whether the pendulum is balanced; the mode's memory begins at ``at``.

    Balancing stops beyond the fall angle or the arm's limits, and when the state is unknown (NaN).
    At the start it begins within the catch angle. After a fall the pendulum must also have been
    slow for the catch time, so that a pendulum on its way through upright is not caught.
    """
    if not _allowed(x, p):
        leave(memory, at)
        return False
    if memory[at + BALANCING] == 0.0 and abs(x[THETA]) <= p.catch_angle:
        slow = abs(x[THETA_DOT]) <= p.catch_speed
        memory[at + READY] = memory[at + READY] + 1.0 if slow else 0.0
        if memory[at + FALLEN] == 0.0 or memory[at + READY] > p.catch_samples:
            memory[at + BALANCING] = 1.0
            memory[at + FALLEN] = memory[at + READY] = 0.0
    elif memory[at + BALANCING] == 0.0:
        memory[at + READY] = 0.0
    return memory[at + BALANCING] != 0.0


@inlined
def still_balancing(memory: np.ndarray, at: int, x: np.ndarray, p: Balance) -> bool:
    """Whether the pendulum was balanced and still is: the usual sample."""
    return (memory[at + BALANCING] != 0.0) & _allowed(x, p)


@inlined
def _allowed(x: np.ndarray, p: Balance) -> bool:
    """Whether the state is known and within the limits."""
    # A comparison with NaN is false.
    return (
        (abs(x[THETA]) <= p.fall_angle)
        & (abs(x[PHI]) <= p.arm_angle_limit)
        & (abs(x[PHI_DOT]) <= p.arm_speed_limit)
        & (not np.isnan(x[THETA_DOT]))
    )


@inlined
def leave(memory: np.ndarray, at: int) -> None:
    """Stop balancing: the pendulum counts as fallen."""
    memory[at + BALANCING] = memory[at + READY] = 0.0
    memory[at + FALLEN] = 1.0
    forget_integrals(memory, at)


@inlined
def reset(memory: np.ndarray, at: int) -> None:
    """Forget a fall and what was integrated: the pendulum has been put back."""
    memory[at + FALLEN] = 0.0
    forget_integrals(memory, at)


@inlined
def forget_integrals(memory: np.ndarray, at: int) -> None:
    """Forget what was integrated: integral action and super-twisting start again."""
    memory[at + INTEGRAL] = 0.0
    memory[at + TWISTING + super_twisting.STARTED] = 0.0


@inlined
def command(memory: np.ndarray, at: int, x: np.ndarray, friction: float, p: Balance) -> float:
    """Command u [V], unsaturated, for the state estimate ``x`` and friction estimate [V]."""
    error = min(max(x[PHI] - p.arm_reference, -p.arm_error_limit), p.arm_error_limit)
    u = friction - p.l1 * error - p.l2 * x[PHI_DOT] - p.l3 * x[THETA] - p.l4 * x[THETA_DOT]
    if p.integral_share > 0.0:
        integral = memory[at + INTEGRAL] + p.integral_share * error
        memory[at + INTEGRAL] = min(max(integral, -p.arm_error_limit), p.arm_error_limit)
        u -= p.l1 * memory[at + INTEGRAL]
    if p.super_twisting.rate_bound > 0.0:
        u += super_twisting.correction(
            memory, at + TWISTING, x, error, p.voltage_limit, p.super_twisting
        )
    return u
