"""What every controller mode is told, and what is to be known of one."""

from typing import NamedTuple

from furuta_model.compiled import inlined
from furuta_model.pendulum import FurutaPendulum

# What a mode does in a sample, and its name for those who watch: the phases of the swing-up.
OFF, SWINGING, CATCHING, BALANCING, BRAKING = range(5)
PHASES = ("off", "swing_up", "catch", "balance", "brake")


class Gain(NamedTuple):
    """L of u = −Lx [V per unit of state]."""

    l1: float
    l2: float
    l3: float
    l4: float


class ControlledRig(NamedTuple):
    """What every mode is told: model with its friction [V s/rad], range [V], L, sample time [s]."""

    model: FurutaPendulum
    viscous: float
    voltage_limit: float
    gain: Gain
    sample_time: float


class Mode(NamedTuple):
    """A mode. Modes with ``feedback`` about upright keep what they remember; others forget it."""

    name: str
    meaning: str
    feedback: bool = False


@inlined
def fed_back(
    friction: float, error: float, phi_dot: float, theta: float, theta_dot: float, gain: Gain
) -> float:
    """Command u [V] for a friction estimate [V], arm error [rad] and state, eq. (8)."""
    return friction - gain.l1 * error - gain.l2 * phi_dot - gain.l3 * theta - gain.l4 * theta_dot
