"""Computes the command in the selected mode: the modes, and one sample of the chosen one.

An excitation signal can be added in every active mode; the sum is limited to the voltage range. To
add a mode, write its file in ``modes/`` and name it here: in :data:`MODES`, in :func:`control`, and
where it has parameters, memory or design.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Annotated, NamedTuple

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
from furuta_control.modes import balance, mode, own, swing_up
from furuta_control.modes.balance import Balance, BalanceMemory, BalanceParameters
from furuta_control.modes.mode import ControlledRig, Gain, Mode
from furuta_control.modes.own import OwnControl
from furuta_control.modes.swing_up import SwingUp, SwingUpMemory, SwingUpParameters
from furuta_model.compiled import inlined
from furuta_model.linear import DesiredPoles, place_poles
from furuta_model.own_functions import OwnMemory, forget_own, kind_and_address
from furuta_model.parameters import INLINE, SELECTS, About, ParameterError, designed_once, shortened
from furuta_model.pendulum import FurutaPendulum

MODES = (
    Mode("balance", "state feedback about upright with friction compensation", feedback=True),
    Mode("open_loop", "the excitation signal alone, at any pendulum angle, for identification"),
    Mode("swing_up", "swing the pendulum up from any angle, catch it and balance", feedback=True),
    Mode("off", "0 V"),
)
_NAMES = tuple(each.name for each in MODES)
# Kinds: places in the list, and one of the user's own.
BALANCE = _NAMES.index("balance")
OPEN_LOOP = _NAMES.index("open_loop")
SWING_UP = _NAMES.index("swing_up")
OWN = len(MODES)
_MEANINGS = "; ".join(f"{each.name}: {each.meaning}" for each in MODES)
# What the controller does in a sample, for those who watch it: the phases of the swing-up, or the
# mode.
ACTIVE_MODES = tuple(dict.fromkeys((*mode.PHASES, *_NAMES, "own")))
# The value of ``gain`` without an explicit gain. It is not empty, because ROS tools do not keep the
# type of an empty list, and not four zeros, because these are a gain.
POLE_PLACEMENT = (0.0,)
# Value of ``running`` in the memory that is no mode plus 1.
NOT_RUNNING = 0


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
    balance: Annotated[BalanceParameters, INLINE] = BalanceParameters()
    friction_timeout: Annotated[
        float,
        About("age beyond which a friction estimate is replaced by 0 V", "s", 0, 10),
    ] = 0.01
    excitation: ExcitationParameters = ExcitationParameters()
    swing_up: SwingUpParameters = SwingUpParameters()
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
        if not np.all(np.isfinite(self.feedback_gain)):
            raise ParameterError(
                "no gain can be computed for these poles and this model; given "
                f"{shortened(self.poles)}, {shortened(self.model)}"
            )
        if not design_controller(self).swing_up.catching.is_finite:
            raise ParameterError(
                f"mode {self.mode} needs a feedback that catches the pendulum, and none can be "
                f"computed for voltage_limit {self.voltage_limit:g} V and "
                f"{shortened(self.model)}"
            )

    @property
    def feedback_gain(self) -> Gain:
        """L of u = −Lx: the explicit one, or by pole placement on the nominal model, eq. (7)."""
        gain: Iterable[float] = self.gain
        if self.gain == POLE_PLACEMENT:
            gain = place_poles(self.model, self.poles, self.model_viscous)
        l1, l2, l3, l4 = map(float, gain)
        return Gain(l1, l2, l3, l4)


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
    swing_up: SwingUp
    excitation: Excitation
    voltage_limit: float
    sample_time: float


@dataclass
class ControllerMemory:
    """What the controller remembers; ``phase`` is that of the excitation [rad].

    ``running`` is the mode plus 1, :data:`NOT_RUNNING` before it begins.
    """

    running: int = NOT_RUNNING
    phase: float = 0.0
    balance: BalanceMemory = field(default_factory=BalanceMemory)
    swing_up: SwingUpMemory = field(default_factory=SwingUpMemory)
    own: OwnMemory = field(default_factory=OwnMemory)


@designed_once
def design_controller(p: ControllerParameters) -> ControllerDesign:
    """The controller that the parameters describe; for another mode only what takes no time."""
    kind, function = kind_and_address(p.mode, _NAMES, OwnControl, float64)
    rig = ControlledRig(p.model, p.model_viscous, p.voltage_limit, p.feedback_gain, p.sample_time)
    balancing = balance.design(rig, p.balance)
    return ControllerDesign(
        enabled=p.enabled,
        mode=kind,
        function=function,
        feedback=kind != OWN and MODES[kind].feedback,
        active=ACTIVE_MODES.index(p.mode if kind != OWN else "own"),
        balance=balancing,
        swing_up=swing_up.design(
            rig,
            p.swing_up,
            balancing,
            is_chosen=kind == SWING_UP,
            keeps_gain=p.gain != POLE_PLACEMENT,
        ),
        excitation=design_excitation(p.excitation, p.sample_time, any_tilt=kind == OPEN_LOOP),
        voltage_limit=p.voltage_limit,
        sample_time=p.sample_time,
    )


@inlined
def control(memory: ControllerMemory, x: np.ndarray, friction: float, p: ControllerDesign) -> float:
    """Command u [V] for the state estimate ``x`` (4 or more) and friction estimate [V]."""
    if memory.running != p.mode + 1:
        begin(memory, p)
    friction = balance.scaled(memory.balance, friction, p.balance)
    return limited(_commanded(memory, x, friction, p), p)


@inlined
def begin(memory: ControllerMemory, p: ControllerDesign) -> None:
    """Begin a mode: at first, after a switch or a restart."""
    memory.running = p.mode + 1
    forget_own(memory.own)
    if not p.feedback:
        balance.leave(memory.balance)
        swing_up.reset(memory.swing_up)


@inlined
def _commanded(
    memory: ControllerMemory, x: np.ndarray, friction: float, p: ControllerDesign
) -> float:
    """Command u [V], unsaturated, with the excitation."""
    u = _driven(memory, x, friction, p)
    if np.isnan(u) or not p.enabled:
        if not p.enabled:
            forget_integrals(memory)
        return 0.0
    if p.excitation.on and within_limits(x, p.excitation):
        u += p.excitation.amplitude * shape(p.excitation.kind, memory.phase)
        memory.phase = (memory.phase + p.excitation.step) % TWO_PI
    return u


@inlined
def _driven(memory: ControllerMemory, x: np.ndarray, friction: float, p: ControllerDesign) -> float:
    """Command u [V] of the mode, unsaturated; NaN if it does not drive."""
    if p.mode == BALANCE:
        return balance.balanced(memory.balance, x, friction, p.balance)
    if p.mode == OPEN_LOOP:
        return 0.0
    if p.mode == SWING_UP:
        return swing_up.command(memory.swing_up, memory.balance, x, friction, p.swing_up)
    if p.mode == OWN:
        g, reference = p.balance.gain, p.balance.parameters.arm_reference
        given = OwnControl(g.l1, g.l2, g.l3, g.l4, reference, p.voltage_limit, p.sample_time)
        return own.command(memory.own, x, friction, p.function, given)
    return np.nan


@inlined
def limited(u: float, p: ControllerDesign) -> float:
    """The command within the voltage range [V]."""
    return min(max(u, -p.voltage_limit), p.voltage_limit)


@inlined
def active_mode(memory: ControllerMemory, p: ControllerDesign) -> int:
    """What the controller does: the index of its name in :data:`ACTIVE_MODES`."""
    if not p.enabled:
        return mode.OFF
    if p.mode == SWING_UP:
        return memory.swing_up.phase
    if p.mode == BALANCE:
        return mode.BALANCING if memory.balance.balancing else mode.OFF
    return p.active


@inlined
def reset(memory: ControllerMemory) -> None:
    """Forget a fall, as the rig has been put back into its initial state."""
    memory.running = NOT_RUNNING
    balance.reset(memory.balance)
    swing_up.reset(memory.swing_up)


@inlined
def forget_integrals(memory: ControllerMemory) -> None:
    """Forget what has been integrated, and an own mode all, as a command is not applied."""
    forget_own(memory.own)
    balance.forget_integrals(memory.balance)
