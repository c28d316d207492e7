"""Mode ``balance``: state feedback about upright with friction compensation, eqs. (6) to (8).

Sign convention of the whole workspace: (1) has u − F on its right side, with F > 0 if friction
opposes positive arm speed. The estimate F̂ is therefore *added*:

    u = −Lx + F̂

The scan of the paper has a minus in (8), which would double the friction.

The arm's error φ − reference is limited before it is fed back. An arm that is far away then returns
at a limited speed, and the pendulum keeps enough of the voltage. For any gain on the error between
0 and L₁ the loop with the paper's gain is stable. Integral action on that error, a rival of
friction compensation, is an option. The strength k scales the compensation, u = −Lx + kF̂.
"""

from dataclasses import dataclass
from math import ceil, expm1, pi
from typing import Annotated, NamedTuple

import numpy as np

from furuta_control.modes.mode import ControlledRig, Gain, fed_back
from furuta_model.compiled import inlined
from furuta_model.parameters import OFF_AT_ZERO, About, ParameterError, designed_once
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

# Time constant with which the strength follows its parameter [s], so that u does not jump.
STRENGTH_TIME = 0.1


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
    """

    balancing: bool = False
    fallen: bool = False
    ready: int = 0
    integral: float = 0.0
    begun: bool = False
    strength: float = 0.0


class BalanceParameters(NamedTuple):
    """Parameters of the mode."""

    fall_angle: Annotated[
        float, About("pendulum angle beyond which the command is 0 V", "rad", 0.01, 3.0)
    ] = 0.7
    catch_angle: Annotated[
        float, About("pendulum angle within which balancing starts", "rad", 0.0, 3.0)
    ] = 0.2
    catch_speed: Annotated[
        float, About("after a fall: highest pendulum speed to start balancing", "rad/s", 0.0, 1e3)
    ] = 2.0
    catch_time: Annotated[
        float,
        About("after a fall: time to stay within catch_angle and catch_speed", "s", 0.0, 10.0),
    ] = 0.05
    arm_reference: Annotated[
        float, About("arm angle at which the arm is held", "rad", -1e6, 1e6)
    ] = 0.0
    arm_error_limit: Annotated[
        float, About("largest arm error that is fed back, so that u stays small", "rad", 1e-3, 1e6)
    ] = 1.0
    integral_time: Annotated[
        float, About("integral time of the arm's error, 0 for no integral action", "s", 0.0, 1e4)
    ] = 0.0
    strength: Annotated[
        float,
        About(
            "scale of the friction estimate: 0 for no compensation, 1 for all of it",
            "",
            0.0,
            4.0,
        ),
    ] = 1.0
    arm_angle_limit: Annotated[
        float, About("arm angle beyond which balancing stops", "rad", 0.01, 1e6)
    ] = 2 * pi
    arm_speed_limit: Annotated[
        float, About("arm speed beyond which balancing stops", "rad/s", 0.1, 1e6)
    ] = 9.9

    def check(self) -> None:
        """Reject a pendulum that is caught beyond the angle at which it has fallen."""
        if self.catch_angle > self.fall_angle:
            raise ParameterError(
                f"catch_angle must not exceed fall_angle, given {self.catch_angle:g} > "
                f"{self.fall_angle:g}"
            )


class Balance(NamedTuple):
    """The mode as :func:`command` uses it: the gain L, its parameters, and what follows from them.

    ``integral_share`` is the sample time over the integral time, 0 without integral action.
    ``strength_share`` is the part of a change of the strength that a sample makes.
    """

    gain: Gain
    parameters: BalanceParameters
    catch_samples: int
    integral_share: Annotated[float, OFF_AT_ZERO]
    strength_share: float


@designed_once
def design(rig: ControlledRig, p: BalanceParameters) -> Balance:
    """Balancing for a rig."""
    dt = rig.sample_time
    return Balance(
        gain=rig.gain,
        parameters=p,
        catch_samples=ceil(p.catch_time / dt),
        integral_share=dt / p.integral_time if p.integral_time > 0.0 else 0.0,
        strength_share=-expm1(-dt / STRENGTH_TIME),
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
    if not memory.balancing and abs(x[THETA]) <= p.parameters.catch_angle:
        slow = abs(x[THETA_DOT]) <= p.parameters.catch_speed
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
        (abs(x[THETA]) <= p.parameters.fall_angle)
        & (abs(x[PHI]) <= p.parameters.arm_angle_limit)
        & (abs(x[PHI_DOT]) <= p.parameters.arm_speed_limit)
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
    """Forget what was integrated."""
    memory.integral = 0.0


@inlined
def scaled(memory: BalanceMemory, friction: float, p: Balance) -> float:
    """The friction estimate [V] times the strength that acts in this sample."""
    if not memory.begun:
        memory.begun, memory.strength = True, p.parameters.strength
    memory.strength += p.strength_share * (p.parameters.strength - memory.strength)
    return memory.strength * friction


@inlined
def command(memory: BalanceMemory, x: np.ndarray, friction: float, p: Balance) -> float:
    """Command u [V], unsaturated, for state estimate ``x`` and :func:`scaled` ``friction`` [V]."""
    limit = p.parameters.arm_error_limit
    error = min(max(x[PHI] - p.parameters.arm_reference, -limit), limit)
    u = fed_back(friction, error, x[PHI_DOT], x[THETA], x[THETA_DOT], p.gain)
    if p.integral_share > 0.0:
        integral = memory.integral + p.integral_share * error
        memory.integral = min(max(integral, -limit), limit)
        u -= p.gain.l1 * memory.integral
    return u


@inlined
def balanced(memory: BalanceMemory, x: np.ndarray, friction: float, p: Balance) -> float:
    """Command u [V] of the mode; NaN if the pendulum is not balanced."""
    if not balances(memory, x, p):
        return np.nan
    return command(memory, x, friction, p)
