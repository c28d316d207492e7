"""Computes the command in the selected mode: the registry of modes and one sample of any of them.

An excitation signal can be added in every active mode; the sum is limited to the voltage range. To
add a mode, write its file in ``modes/`` and add it here: a row of :data:`MODES`, its parameters,
and its branch in :func:`_mode_command`.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil, isfinite, pi
from typing import Annotated, NamedTuple

import numpy as np

from furuta_control.excitation import (
    NONE,
    TWO_PI,
    Excitation,
    ExcitationParameters,
    design_excitation,
    shape,
    within_limits,
)
from furuta_control.modes import balance, super_twisting, swing_up
from furuta_control.modes.balance import Balance
from furuta_control.modes.swing_up import SwingUp, SwingUpParameters
from furuta_model.compiled import inlined
from furuta_model.linear import DesiredPoles, place_poles
from furuta_model.parameters import INLINE, About, ParameterError, shortened
from furuta_model.pendulum import FurutaPendulum

# Name and meaning.
MODES = {
    "balance": "state feedback about upright with friction compensation",
    "open_loop": "the excitation signal alone, at any pendulum angle, for identification",
    "swing_up": "swing the pendulum up from any angle, catch it and balance",
    "off": "0 V",
}
BALANCE, OPEN_LOOP, SWING_UP, OFF = range(4)
_MEANINGS = "; ".join(f"{name}: {meaning}" for name, meaning in MODES.items())

# The controller's memory: the phase of the excitation, then the memory of each mode.
PHASE = 0
BALANCE_MEMORY = 1
SWING_UP_MEMORY = BALANCE_MEMORY + balance.MEMORY
MEMORY = SWING_UP_MEMORY + swing_up.MEMORY

INACTIVE = (0.0, False)

# What the controller does in a sample, for those who watch it.
ACTIVE_MODES = (*swing_up.PHASES, "open_loop")
OPEN_LOOP_ACTIVE = len(swing_up.PHASES)

# The value of ``gain`` without an explicit gain. It is not empty, because ROS tools do not keep the
# type of an empty list, and not four zeros, because these are a gain.
POLE_PLACEMENT = (0.0,)


class ControllerParameters(NamedTuple):
    """Parameters of the node ``controller``."""

    enabled: Annotated[bool, About("drive the arm; 0 V if false")] = True
    mode: Annotated[
        str,
        About(_MEANINGS, choices=tuple(MODES)),
    ] = "balance"
    poles: Annotated[DesiredPoles, INLINE] = DesiredPoles()
    gain: Annotated[
        tuple[float, ...],
        About("explicit L of u = -Lx: four numbers; [0.0]: L by pole placement", "V/x"),
    ] = POLE_PLACEMENT
    model: FurutaPendulum = FurutaPendulum()
    model_viscous: Annotated[
        float,
        About(
            "viscous friction in the model of the pole placement; the friction estimate must then "
            "not contain it",
            "V s/rad",
            0,
            100,
        ),
    ] = 0.0
    voltage_limit: Annotated[float, About("largest command", "V", 0.0, 1e3)] = 10.0
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
        float, About("after a fall: time within catch angle and speed before it", "s", 0.0, 10.0)
    ] = 0.05
    arm_reference: Annotated[
        float, About("arm angle at which the arm is held", "rad", -1e6, 1e6)
    ] = 0.0
    arm_error_limit: Annotated[
        float, About("largest arm error that is fed back, so that u stays small", "rad", 1e-3, 1e6)
    ] = 1.0
    integral_time: Annotated[
        float, About("time of the integral action on the arm's error, 0 for none", "s", 0.0, 1e4)
    ] = 0.0
    super_twisting: Annotated[
        float, About("super-twisting: bound on the friction's rate, 0 for none", "V/s", 0.0, 1e4)
    ] = 0.0
    arm_angle_limit: Annotated[
        float, About("arm angle beyond which balancing stops", "rad", 0.01, 1e6)
    ] = 2 * pi
    arm_speed_limit: Annotated[
        float, About("arm speed beyond which balancing stops", "rad/s", 0.1, 1e6)
    ] = 9.9
    friction_timeout: Annotated[
        float,
        About("age up to which a friction estimate is used, then 0 V", "s", 0, 10),
    ] = 0.01
    excitation: ExcitationParameters = ExcitationParameters()
    swing_up: SwingUpParameters = SwingUpParameters()
    sample_time: Annotated[
        float, About("time between commands", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001

    def check(self) -> None:
        """Reject a gain of the wrong length, and a catch angle larger than the fall angle."""
        if len(self.gain) != 4 and self.gain != POLE_PLACEMENT:
            raise ParameterError(
                "gain must be four numbers (phi, phi_dot, theta, theta_dot), or [0.0] for pole "
                f"placement, given {shortened(list(self.gain))}"
            )
        if not all(isfinite(each) for each in self.feedback_gain):
            raise ParameterError(
                "no gain can be computed for these poles and this model; given "
                f"{shortened(self.poles)}, {shortened(self.model)}"
            )
        if self.catch_angle > self.fall_angle:
            raise ParameterError(
                f"catch_angle must not exceed fall_angle, given {self.catch_angle:g} > "
                f"{self.fall_angle:g}"
            )
        if self.mode == list(MODES)[SWING_UP] and not swing_up.is_possible(
            self.model, self.model_viscous, _balance(self), self.sample_time
        ):
            raise ParameterError(
                f"mode {self.mode} needs a feedback that catches the pendulum, and none can be "
                f"computed for voltage_limit {self.voltage_limit:g} V and "
                f"{shortened(self.model)}"
            )

    @property
    def feedback_gain(self) -> tuple[float, float, float, float]:
        """L of u = −Lx: the explicit one, or by pole placement on the nominal model, eq. (7)."""
        placed = self.gain == POLE_PLACEMENT
        gain: Iterable[float] = self.gain
        if placed:
            gain = place_poles(self.model, self.poles, self.model_viscous)
        l1, l2, l3, l4 = (float(each) for each in gain)
        return l1, l2, l3, l4


class ControllerDesign(NamedTuple):
    """The controller as :func:`control` uses it."""

    enabled: bool
    mode: int
    balance: Balance
    excitation: Excitation
    voltage_limit: float
    swing_up: SwingUp


def design_controller(p: ControllerParameters) -> ControllerDesign:
    """The controller that the parameters describe."""
    mode, balancing = list(MODES).index(p.mode), _balance(p)
    return ControllerDesign(
        p.enabled,
        mode,
        balancing,
        design_excitation(p.excitation, p.sample_time, any_tilt=mode == OPEN_LOOP),
        p.voltage_limit,
        swing_up.design(
            p.swing_up,
            p.model,
            p.model_viscous,
            balancing,
            p.sample_time,
            used=mode == SWING_UP,
            own_gain=p.gain == POLE_PLACEMENT,
        ),
    )


def _balance(p: ControllerParameters) -> Balance:
    return Balance(
        *p.feedback_gain,
        p.fall_angle,
        p.arm_angle_limit,
        p.arm_speed_limit,
        p.catch_angle,
        p.catch_speed,
        ceil(p.catch_time / p.sample_time),
        p.arm_reference,
        p.arm_error_limit,
        p.sample_time / p.integral_time if p.integral_time > 0.0 else 0.0,
        super_twisting.design(
            p.super_twisting, p.model, p.model_viscous, p.feedback_gain, p.sample_time
        ),
        p.voltage_limit,
    )


@inlined
def control(memory: np.ndarray, x: np.ndarray, friction: float, p: ControllerDesign) -> float:
    """Command u [V] for the state estimate ``x`` (4 or more) and friction estimate [V]."""
    u, active = _mode_command(memory, x, friction, p)
    if not active or not p.enabled:
        return 0.0
    if p.excitation.kind != NONE and within_limits(x, p.excitation):
        u += p.excitation.amplitude * shape(p.excitation.kind, memory[PHASE])
        memory[PHASE] = (memory[PHASE] + p.excitation.step) % TWO_PI
    return min(max(u, -p.voltage_limit), p.voltage_limit)


@inlined
def continues(memory: np.ndarray, x: np.ndarray, p: ControllerDesign) -> bool:
    """Whether the pendulum was balanced and still is, without excitation: the usual sample."""
    plain = p.enabled and p.mode == BALANCE and p.excitation.kind == NONE
    return plain and balance.still_balancing(memory, BALANCE_MEMORY, x, p.balance)


@inlined
def continue_control(
    memory: np.ndarray, x: np.ndarray, friction: float, p: ControllerDesign
) -> float:
    """:func:`control` for a sample in which it :func:`continues`."""
    u = balance.command(memory, BALANCE_MEMORY, x, friction, p.balance)
    return min(max(u, -p.voltage_limit), p.voltage_limit)


@inlined
def active_mode(memory: np.ndarray, p: ControllerDesign) -> int:
    """What the controller does: the index of its name in :data:`ACTIVE_MODES`."""
    if not p.enabled or p.mode == OFF:
        return swing_up.OFF
    if p.mode == SWING_UP:
        return int(memory[SWING_UP_MEMORY + swing_up.PHASE])
    if p.mode == OPEN_LOOP:
        return OPEN_LOOP_ACTIVE
    balancing = memory[BALANCE_MEMORY + balance.BALANCING] != 0.0
    return swing_up.BALANCING if balancing else swing_up.OFF


@inlined
def reset(memory: np.ndarray) -> None:
    """Forget a fall, as the rig has been put back into its initial state."""
    balance.reset(memory, BALANCE_MEMORY)
    swing_up.reset(memory, SWING_UP_MEMORY)


@inlined
def forget_integrals(memory: np.ndarray) -> None:
    """Forget what has been integrated, as the last command was not applied."""
    balance.forget_integrals(memory, BALANCE_MEMORY)


@inlined
def _mode_command(
    memory: np.ndarray, x: np.ndarray, friction: float, p: ControllerDesign
) -> tuple[float, bool]:
    """Command u [V] of the mode, and whether the mode is active."""
    if p.mode == BALANCE:
        if not balance.balances(memory, BALANCE_MEMORY, x, p.balance):
            return INACTIVE
        return balance.command(memory, BALANCE_MEMORY, x, friction, p.balance), True
    if p.mode == SWING_UP:
        u = swing_up.command(memory, SWING_UP_MEMORY, BALANCE_MEMORY, x, friction, p.swing_up)
        return (0.0, False) if np.isnan(u) else (u, True)
    balance.leave(memory, BALANCE_MEMORY)
    swing_up.reset(memory, SWING_UP_MEMORY)
    if p.mode == OPEN_LOOP:
        return 0.0, True
    return INACTIVE
