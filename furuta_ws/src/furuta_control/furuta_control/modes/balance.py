"""Mode ``balance``: state feedback about upright with friction compensation, eqs. (6) to (8).

Sign convention of the whole workspace: (1) has u − F on its right side, with F > 0 if friction
opposes positive arm speed. The estimate F̂ is therefore *added*:

    u = −Lx + F̂

The scan of the paper has a minus in (8), which would double the friction.

The arm's error φ − reference is limited before it is fed back. An arm that is far away then returns
at a limited speed, and the pendulum keeps enough of the voltage. For any gain on the error between
0 and L₁ the loop with the paper's gain is stable. Two rivals of friction compensation are options:
integral action on that error, and :mod:`furuta_friction.super_twisting` with the correction v. The
strength k scales the whole compensation, u = −Lx + k(F̂ + v).
"""

from dataclasses import dataclass, field
from math import ceil, expm1
from typing import Annotated, Any, NamedTuple

import numpy as np

from furuta_control.modes.mode import Mode
from furuta_friction import super_twisting
from furuta_friction.super_twisting import SuperTwisting, SuperTwistingMemory
from furuta_model.compiled import inlined
from furuta_model.parameters import OFF_AT_ZERO
from furuta_model.registry import designed_once
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

# The value of ``gain`` without an explicit gain. It is not empty, because ROS tools do not keep the
# type of an empty list, and not four zeros, because these are a gain.
POLE_PLACEMENT = (0.0,)
# Time constant with which the strength follows its parameter [s], so that u does not jump.
STRENGTH_TIME = 0.1
# Largest integral of super-twisting, relative to its gain [s]: twice the level of friction that the
# gain is for. Without a limit it is integral action, which lets the pendulum fall.
INTEGRAL_LIMIT = 2.0 / super_twisting.FRICTION_RATE
# Strength below which super-twisting rests.
LEAST_STRENGTH = 1e-3


@dataclass
class BalanceMemory:
    """What the mode remembers.

    Attributes:
        balancing: Whether the pendulum is balanced.
        fallen: Whether it has fallen and not been caught since.
        ready: Samples for which it has been ready to be caught.
        integral: Integral of the arm's error over the integral time [rad].
        begun: Whether the strength has begun at its parameter.
        strength: The strength that acts.
        super_twisting: Memory of super-twisting.
    """

    balancing: bool = False
    fallen: bool = False
    ready: int = 0
    integral: float = 0.0
    begun: bool = False
    strength: float = 0.0
    super_twisting: SuperTwistingMemory = field(default_factory=SuperTwistingMemory)


class Balance(NamedTuple):
    """Gain L of u = −Lx [V per unit of state], and when balancing stops and starts.

    Angles [rad], speeds [rad/s], number of samples. ``integral_share`` is the sample time over the
    integral time, 0 without integral action; ``integral_limit`` [V] is that of super-twisting.
    ``strength_share`` is the part of a change of the strength that a sample makes.
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
    catch_samples: int
    arm_reference: float
    arm_error_limit: float
    integral_share: Annotated[float, OFF_AT_ZERO]
    strength: float
    strength_share: float
    super_twisting: SuperTwisting
    integral_limit: float


@designed_once
def design(p: Any) -> Balance:
    """Balancing for all parameters of the controller."""
    l1, l2, l3, l4 = gain = p.feedback_gain
    return Balance(
        l1=l1,
        l2=l2,
        l3=l3,
        l4=l4,
        fall_angle=p.fall_angle,
        arm_angle_limit=p.arm_angle_limit,
        arm_speed_limit=p.arm_speed_limit,
        catch_angle=p.catch_angle,
        catch_speed=p.catch_speed,
        catch_samples=ceil(p.catch_time / p.sample_time),
        arm_reference=p.arm_reference,
        arm_error_limit=p.arm_error_limit,
        integral_share=p.sample_time / p.integral_time if p.integral_time > 0.0 else 0.0,
        strength=p.strength,
        strength_share=-expm1(-p.sample_time / STRENGTH_TIME),
        super_twisting=super_twisting.design_for_pendulum(
            p.super_twisting,
            p.super_twisting_bandwidth,
            p.vibration_limit,
            p.model,
            p.model_viscous,
            gain,
            p.sample_time,
        ),
        integral_limit=min(p.voltage_limit, INTEGRAL_LIMIT * p.super_twisting),
    )


@inlined
def balances(memory: BalanceMemory, x: np.ndarray, p: Balance) -> bool:
    """Whether the pendulum is balanced.

    Balancing stops beyond the fall angle or the arm's limits, and when the state is unknown (NaN).
    At the start it begins within the catch angle. After a fall the pendulum must also have been
    slow for the catch time, so that a pendulum on its way through upright is not caught.
    """
    if not is_allowed(x, p):
        leave(memory)
        return False
    if not memory.balancing and abs(x[THETA]) <= p.catch_angle:
        slow = abs(x[THETA_DOT]) <= p.catch_speed
        memory.ready = memory.ready + 1 if slow else 0
        if not memory.fallen or memory.ready > p.catch_samples:
            begin(memory)
    elif not memory.balancing:
        memory.ready = 0
    return memory.balancing


@inlined
def is_allowed(x: np.ndarray, p: Balance) -> bool:
    """Whether the state is known and within the limits."""
    # A comparison with NaN is false.
    return (
        (abs(x[THETA]) <= p.fall_angle)
        & (abs(x[PHI]) <= p.arm_angle_limit)
        & (abs(x[PHI_DOT]) <= p.arm_speed_limit)
        & (not np.isnan(x[THETA_DOT]))
    )


@inlined
def begin(memory: BalanceMemory) -> None:
    """Start balancing: the pendulum has been caught."""
    memory.balancing, memory.fallen, memory.ready = True, False, 0


@inlined
def leave(memory: BalanceMemory) -> None:
    """Stop balancing: the pendulum counts as fallen."""
    memory.balancing, memory.fallen, memory.ready = False, True, 0
    forget_integrals(memory)


@inlined
def reset(memory: BalanceMemory) -> None:
    """Forget a fall and what was integrated: the pendulum has been put back."""
    memory.fallen = False
    forget_integrals(memory)


@inlined
def forget_integrals(memory: BalanceMemory) -> None:
    """Forget what was integrated: integral action and super-twisting start again."""
    memory.integral = 0.0
    memory.super_twisting.started = False


@inlined
def scaled(memory: BalanceMemory, friction: float, p: Balance) -> float:
    """The friction estimate [V] times the strength that acts in this sample."""
    if not memory.begun:
        memory.begun, memory.strength = True, p.strength
    memory.strength += p.strength_share * (p.strength - memory.strength)
    return memory.strength * friction


@inlined
def command(memory: BalanceMemory, x: np.ndarray, friction: float, p: Balance) -> float:
    """Command u [V], unsaturated, for state estimate ``x`` and :func:`scaled` ``friction`` [V]."""
    error = min(max(x[PHI] - p.arm_reference, -p.arm_error_limit), p.arm_error_limit)
    u = friction - p.l1 * error - p.l2 * x[PHI_DOT] - p.l3 * x[THETA] - p.l4 * x[THETA_DOT]
    if p.integral_share > 0.0:
        integral = memory.integral + p.integral_share * error
        memory.integral = min(max(integral, -p.arm_error_limit), p.arm_error_limit)
        u -= p.l1 * memory.integral
    if memory.strength < LEAST_STRENGTH:
        memory.super_twisting.started = False
    elif p.super_twisting.rate_bound > 0.0:
        u += super_twisting.correction(
            memory.super_twisting, x, error, memory.strength, p.integral_limit, p.super_twisting
        )
    return u


@inlined
def _drive(memory: Any, x: np.ndarray, friction: float, p: Any) -> float:
    """Command u [V]; NaN if the pendulum is not balanced."""
    if not balances(memory.balance, x, p.balance):
        return np.nan
    return command(memory.balance, x, friction, p.balance)


PART = Mode(
    "balance",
    "state feedback about upright with friction compensation",
    _drive,
    feedback=True,
)
