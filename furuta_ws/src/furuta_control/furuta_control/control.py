"""Computes the command in the selected mode: the registry of modes and one sample of any of them.

An excitation signal can be added in every active mode; the sum is limited to the voltage range. To
add a mode, write its file in ``modes/`` and add it to :data:`FILES`; its parameters, memory and
design stand in its file.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import pi
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeAlias

import numpy as np
from numba import float64

from furuta_control.excitation import (
    TWO_PI,
    Excitation,
    ExcitationParameters,
    design_excitation,
    shape,
    within_limits,
)
from furuta_control.modes import balance, open_loop, own, swing_up
from furuta_control.modes.balance import POLE_PLACEMENT, Balance, BalanceMemory
from furuta_control.modes.mode import Mode
from furuta_control.modes.own import OwnControl
from furuta_model.compiled import by_kind, inlined
from furuta_model.linear import DesiredPoles, place_poles
from furuta_model.own_functions import OwnMemory, forget_own, own_part, sample_function
from furuta_model.parameters import INLINE, SELECTS, About, ParameterError, shortened
from furuta_model.pendulum import FurutaPendulum
from furuta_model.registry import design_parts, designed_once, groups_of, in_turn, parts_in

FILES = (
    "balance",
    "open_loop",
    "swing_up",
    "off",
)

MODES: tuple[Mode, ...] = parts_in("furuta_control.modes", FILES)
_NAMES = tuple(mode.name for mode in MODES)
_MEANINGS = "; ".join(f"{mode.name}: {mode.meaning}" for mode in MODES)
# Kind of a mode of the user's own, and its name for those who watch.
_OWN, _OWN_NAME = len(MODES), "own"
_reset_parts = in_turn(mode.reset for mode in MODES if mode.reset is not None)
_mode_command = by_kind([*(mode.command for mode in MODES), own.command])

# What the controller does in a sample, for those who watch it: the phases of the swing-up, or the
# mode.
ACTIVE_MODES = tuple(dict.fromkeys((*swing_up.PHASES, *_NAMES, _OWN_NAME)))
_BALANCE, _SWING_UP = MODES.index(balance.PART), MODES.index(swing_up.PART)

if TYPE_CHECKING:
    ModeParameters: TypeAlias = Any
    ModeMemories: TypeAlias = Any
    ModeDesigns: TypeAlias = Any
else:
    ModeParameters, ModeMemories, ModeDesigns = groups_of(MODES, __name__, "Mode")


class ControllerParameters(NamedTuple):
    """Parameters of the node ``controller``."""

    enabled: Annotated[bool, About("drive the arm; if false, the command is 0 V")] = True
    mode: Annotated[str, About(_MEANINGS, choices=_NAMES, own=True)] = "balance"
    poles: Annotated[DesiredPoles, INLINE] = DesiredPoles()
    gain: Annotated[
        tuple[float, ...],
        About("the four numbers of L in u = -Lx; [0.0]: L by pole placement", "V/x"),
    ] = POLE_PLACEMENT
    model: FurutaPendulum = FurutaPendulum()
    model_viscous: Annotated[
        float,
        About(
            "viscous friction of the arm in the model of the pole placement; the friction estimate "
            "must not contain it",
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
            "scale of the whole compensation, friction estimate and super-twisting: 0 for none, 1 "
            "as designed; lower it if the compensation shakes the arm, as with a late drive",
            "",
            0.0,
            4.0,
        ),
    ] = 1.0
    super_twisting: Annotated[
        float,
        About("super-twisting: gain, the largest rate of friction, 0 for off", "V/s", 0.0, 1e4),
    ] = 0.0
    super_twisting_bandwidth: Annotated[
        float,
        About("super-twisting: bandwidth that limits the gain, 0 for none", "1/s", 0.0, 1e4),
    ] = 0.0
    vibration_limit: Annotated[
        float,
        About("super-twisting: vibration amplitude above which it is reduced", "V", 1e-3, 1e6),
    ] = 0.8
    arm_angle_limit: Annotated[
        float, About("arm angle beyond which balancing stops", "rad", 0.01, 1e6)
    ] = 2 * pi
    arm_speed_limit: Annotated[
        float, About("arm speed beyond which balancing stops", "rad/s", 0.1, 1e6)
    ] = 9.9
    friction_timeout: Annotated[
        float,
        About("age beyond which a friction estimate is replaced by 0 V", "s", 0, 10),
    ] = 0.01
    excitation: ExcitationParameters = ExcitationParameters()
    parts: Annotated[ModeParameters, INLINE] = ModeParameters()
    sample_time: Annotated[
        float, About("time between commands", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001

    def check(self) -> None:
        """Reject a gain of the wrong length, and what cannot be designed."""
        if len(self.gain) != 4 and self.gain != POLE_PLACEMENT:
            raise ParameterError(
                "gain must be four numbers (phi, phi_dot, theta, theta_dot), or [0.0] for pole "
                f"placement, given {shortened(list(self.gain))}"
            )
        if not np.all(np.isfinite(balance.design(self)[:4])):
            raise ParameterError(
                "no gain can be computed for these poles and this model; given "
                f"{shortened(self.poles)}, {shortened(self.model)}"
            )
        if self.catch_angle > self.fall_angle:
            raise ParameterError(
                f"catch_angle must not exceed fall_angle, given {self.catch_angle:g} > "
                f"{self.fall_angle:g}"
            )
        if not np.all(np.isfinite(design_controller(self).parts.swing_up.catching)):
            raise ParameterError(
                f"mode {self.mode} needs a feedback that catches the pendulum, and none can be "
                f"computed for voltage_limit {self.voltage_limit:g} V and "
                f"{shortened(self.model)}"
            )

    @property
    def feedback_gain(self) -> tuple[float, float, float, float]:
        """L of u = −Lx: the explicit one, or by pole placement on the nominal model, eq. (7)."""
        gain: Iterable[float] = self.gain
        if self.gain == POLE_PLACEMENT:
            gain = place_poles(self.model, self.poles, self.model_viscous)
        l1, l2, l3, l4 = map(float, gain)
        return l1, l2, l3, l4


class ControllerDesign(NamedTuple):
    """The controller as :func:`control` uses it; ``function`` is the address of an own mode.

    ``feedback``: whether the mode feeds back about upright. ``active`` is the index of the mode in
    :data:`ACTIVE_MODES`.
    """

    enabled: bool
    mode: Annotated[int, SELECTS]
    function: int
    feedback: Annotated[bool, SELECTS]
    active: int
    balance: Balance
    excitation: Excitation
    voltage_limit: float
    sample_time: float
    parts: ModeDesigns


@dataclass
class ControllerMemory:
    """What the controller remembers; ``phase`` is that of the excitation [rad]."""

    phase: float = 0.0
    balance: BalanceMemory = field(default_factory=BalanceMemory)
    parts: ModeMemories = field(default_factory=ModeMemories)
    own: OwnMemory = field(default_factory=OwnMemory)


@designed_once
def design_controller(p: ControllerParameters) -> ControllerDesign:
    """The controller that the parameters describe."""
    mode, function = _OWN, 0
    if p.mode in _NAMES:
        mode = _NAMES.index(p.mode)
    else:
        function = sample_function(own_part(p.mode, Mode, "own").command, OwnControl, float64)
    any_tilt = p.mode == open_loop.PART.name
    return ControllerDesign(
        enabled=p.enabled,
        mode=mode,
        function=function,
        feedback=mode != _OWN and MODES[mode].feedback,
        active=ACTIVE_MODES.index(p.mode if mode != _OWN else _OWN_NAME),
        balance=balance.design(p),
        excitation=design_excitation(p.excitation, p.sample_time, any_tilt=any_tilt),
        voltage_limit=p.voltage_limit,
        sample_time=p.sample_time,
        parts=ModeDesigns(*design_parts(MODES, p)),
    )


@inlined
def control(memory: ControllerMemory, x: np.ndarray, friction: float, p: ControllerDesign) -> float:
    """Command u [V] for the state estimate ``x`` (4 or more) and friction estimate [V]."""
    if not p.feedback:
        balance.leave(memory.balance)
        _reset_parts(memory)
    friction = balance.scaled(memory.balance, friction, p.balance)
    u = _mode_command(p.mode, memory, x, friction, p)
    if np.isnan(u) or not p.enabled:
        if not p.enabled:
            forget_integrals(memory)
        return 0.0
    if p.excitation.on and within_limits(x, p.excitation):
        u += p.excitation.amplitude * shape(p.excitation.kind, memory.phase)
        memory.phase = (memory.phase + p.excitation.step) % TWO_PI
    return limited(u, p)


@inlined
def limited(u: float, p: ControllerDesign) -> float:
    """The command within the voltage range [V]."""
    return min(max(u, -p.voltage_limit), p.voltage_limit)


@inlined
def active_mode(memory: ControllerMemory, p: ControllerDesign) -> int:
    """What the controller does: the index of its name in :data:`ACTIVE_MODES`."""
    if not p.enabled:
        return swing_up.OFF
    if p.mode == _SWING_UP:
        return memory.parts.swing_up.phase
    if p.mode == _BALANCE:
        return swing_up.BALANCING if memory.balance.balancing else swing_up.OFF
    return p.active


@inlined
def reset(memory: ControllerMemory) -> None:
    """Forget a fall, as the rig has been put back into its initial state."""
    forget_own(memory.own)
    balance.reset(memory.balance)
    _reset_parts(memory)


@inlined
def forget_integrals(memory: ControllerMemory) -> None:
    """Forget what has been integrated, and an own mode all, as a command is not applied."""
    forget_own(memory.own)
    balance.forget_integrals(memory.balance)
