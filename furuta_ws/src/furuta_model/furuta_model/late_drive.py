r"""A drive that is known to be late: the torque that acts now, and the state when a command acts.

A command acts after the delay of the drive, and its torque follows with a first-order lag. The
torque of commands that have been sent but do not act yet is known, so the linear model predicts the
state over delay and lag; within the lag the last command is held. Friction is not predicted: the
commands are those of the feedback alone, as if its compensation were exact (Artstein, IEEE Trans.
Automatic Control 27, 1982).
"""

from dataclasses import dataclass
from math import expm1
from typing import Annotated, Final, NamedTuple

import numpy as np

from furuta_model.block import zeros
from furuta_model.compiled import compiled, inlined
from furuta_model.parameters import INLINE, SELECTS, About
from furuta_model.state import RIGID_STATES

# Largest delay of drive and sensors [samples].
MAX_DELAY: Final = 100
DELAY_SLOTS: Final = MAX_DELAY + 1


class LateDrive(NamedTuple):
    """How late a drive is: as it is, or as is known; a rig file states it."""

    delay: Annotated[int, About("delay of the drive", "samples", 0, MAX_DELAY)] = 0
    lag: Annotated[float, About("time constant of the drive's torque, 0 for none", "s", 0, 1)] = 0.0

    @property
    def is_late(self) -> bool:
        """Whether a command acts later than at once."""
        return self.delay > 0 or self.lag > 0.0


class Drive(NamedTuple):
    """Dynamics of the simulated drive. The measurement contains its voltage, not the torque."""

    late: Annotated[LateDrive, INLINE] = LateDrive()
    dead_band: Annotated[
        float,
        About("voltage up to which there is no torque; above it only the excess acts", "V", 0, 10),
    ] = 0.0


@dataclass
class DriveMemory:
    """The last voltages, the place of the next one, and the torque at the end of the sample [V]."""

    voltages: np.ndarray = zeros(DELAY_SLOTS)
    place: int = 0
    torque: float = 0.0


class SampledDrive(NamedTuple):
    """The drive: whether it has a delay, and shares of a new voltage at the end and in the mean."""

    delayed: Annotated[bool, SELECTS]
    delay: int
    end_share: float
    mean_share: float


AT_ONCE = SampledDrive(delayed=False, delay=0, end_share=1.0, mean_share=1.0)


def design_drive(p: LateDrive, dt: float) -> SampledDrive:
    """The drive for a sample time [s]."""
    if p.lag == 0.0:
        return AT_ONCE._replace(delayed=p.delay > 0, delay=p.delay)
    d = dt / p.lag
    end_share = -expm1(-d)
    return SampledDrive(p.delay > 0, p.delay, end_share, 1.0 - end_share / d)


@compiled
def without_dead_band(voltage: float, width: float) -> float:
    """The part of a voltage beyond ±``width`` [V]."""
    if abs(voltage) <= width:
        return 0.0
    return voltage - width if voltage > 0.0 else voltage + width


@inlined
def acting_torque(memory: DriveMemory, voltage: float, p: SampledDrive) -> float:
    """Mean torque [V] over the sample in which the drive has been given ``voltage`` [V].

    So the momentum is exact. What changes within a sample is that of a delay far below one.
    """
    memory.voltages[memory.place] = voltage
    due = voltage
    if p.delayed:
        due = sent_before(memory, p.delay)
    memory.place = memory.place + 1 if memory.place + 1 < DELAY_SLOTS else 0
    step = due - memory.torque
    mean = memory.torque + p.mean_share * step
    memory.torque += p.end_share * step
    return mean


@inlined
def sent_before(memory: DriveMemory, samples: int) -> float:
    """What has been sent so many places before the next one."""
    place = memory.place - samples
    return memory.voltages[place if place >= 0 else place + DELAY_SLOTS]


@inlined
def assume_held(memory: DriveMemory, voltage: float) -> None:
    """Remember as if this voltage had been sent for long."""
    for place in range(DELAY_SLOTS):
        memory.voltages[place] = voltage
    memory.torque = voltage


class Prediction(NamedTuple):
    """The linear prediction.

    ``state`` (4, 4) and ``torque`` (4,) are the parts of the present state and torque,
    ``response`` (4, n) that of the voltages that have been sent, the last one first, of which
    ``pending`` count.
    """

    pending: int
    state: np.ndarray
    torque: np.ndarray
    response: np.ndarray


def design_prediction(
    a: np.ndarray, b: np.ndarray, drive: LateDrive, dt: float, horizon: float = 0.0
) -> Prediction:
    """The prediction for ẋ = Ax + Bτ over the lateness of the drive, at least a ``horizon`` [s].

    A (4, 4), B (4,); samples of ``dt`` [s].
    """
    from scipy.linalg import expm  # noqa: PLC0415 - slow; nodes without prediction start sooner

    held = max(round(max(drive.lag, horizon - drive.delay * dt) / dt), 0)
    response = np.zeros((RIGID_STATES + 1, DELAY_SLOTS))
    sampled, step = design_drive(drive, dt), np.zeros((RIGID_STATES + 2, RIGID_STATES + 2))
    system = np.zeros((RIGID_STATES + 1, RIGID_STATES + 1))
    system[:RIGID_STATES, :RIGID_STATES], system[:RIGID_STATES, RIGID_STATES] = a, b
    # State, torque and voltage over a sample.
    exact = expm(system * dt)[:RIGID_STATES]
    step[:RIGID_STATES, :RIGID_STATES] = exact[:, :RIGID_STATES]
    step[:RIGID_STATES, -2] = (1.0 - sampled.mean_share) * exact[:, -1]
    step[:RIGID_STATES, -1] = sampled.mean_share * exact[:, -1]
    step[-2, -2:] = 1.0 - sampled.end_share, sampled.end_share
    step[-1, -1] = 1.0
    over_lag = np.linalg.matrix_power(step, held).copy()
    response[:, 0] = over_lag[:-1, -1]
    for sample in range(drive.delay):
        response[:, sample] += over_lag[:-1, :-1] @ step[:-1, -1]
        over_lag[:-1, :-1] = over_lag[:-1, :-1] @ step[:-1, :-1]
    states = over_lag[:-1, :-1]
    return Prediction(
        pending=max(drive.delay, 1),
        state=states[:RIGID_STATES, :RIGID_STATES].copy(),
        torque=states[:RIGID_STATES, RIGID_STATES].copy(),
        response=response[:RIGID_STATES].copy(),
    )


@inlined
def predicted(memory: DriveMemory, x: np.ndarray, i: int, p: Prediction) -> float:
    """State ``i`` when a command that is sent now acts, from the present state ``x``."""
    value = p.torque[i] * memory.torque
    for j in range(RIGID_STATES):
        value += p.state[i, j] * x[j]
    for sample in range(p.pending):
        value += p.response[i, sample] * sent_before(memory, sample + 1)
    return value
