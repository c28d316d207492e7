"""An excitation signal added to the command, so that a recording identifies more of the rig.

Outside its limits of angle and speed the signal is zero and its phase stands still, until the
feedback has brought arm and pendulum back. In mode ``open_loop`` it is the whole command, and the
angle of the pendulum does not limit it.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.parameters import About
from furuta_model.state import PHI, PHI_DOT, THETA

NONE, STEPS, SINE, MULTISINE = range(4)
KINDS = ("none", "steps", "sine", "multisine")
TURN = 2.0 * np.pi
# Harmonics of the multisine, of equal size.
HARMONICS = 8
# Largest value of their sum.
MULTISINE_PEAK = 3.781


class ExcitationParameters(NamedTuple):
    """What is added to the command, and within which limits."""

    kind: Annotated[
        str,
        About(
            "signal added to the command for identification: steps up and down, a sine, or a "
            f"multisine of the first {HARMONICS} harmonics",
            choices=KINDS,
        ),
    ] = "none"
    amplitude: Annotated[float, About("largest value of the signal", "V", 0.0, 1e3)] = 1.0
    period: Annotated[float, About("period of the signal", "s", 0.01, 1e3)] = 4.0
    tilt_limit: Annotated[
        float, About("pendulum angle beyond which the signal is 0 V", "rad", 0.0, 3.0)
    ] = 0.1
    excursion_limit: Annotated[
        float, About("arm angle beyond which the signal is 0 V", "rad", 0.0, 1e3)
    ] = 1.0
    speed_limit: Annotated[
        float, About("arm speed beyond which the signal is 0 V", "rad/s", 0.0, 1e3)
    ] = 2.0


class Excitation(NamedTuple):
    """What the signal is computed with; ``step`` is its phase in a sample [rad].

    With ``any_tilt`` the pendulum's angle does not limit it.
    """

    kind: int
    amplitude: float
    step: float
    tilt_limit: float
    excursion_limit: float
    speed_limit: float
    any_tilt: bool


def excitation(p: ExcitationParameters, sample_time: float, any_tilt: bool = False) -> Excitation:
    """The signal for samples of ``sample_time`` [s]."""
    step = TURN * min(sample_time / p.period, 0.5)
    return Excitation(KINDS.index(p.kind), p.amplitude, step, *p[3:], any_tilt)


@inlined
def within_limits(x: np.ndarray, p: Excitation) -> bool:
    """Whether arm and pendulum of the state ``x`` are within the limits."""
    return (
        (p.any_tilt or abs(x[THETA]) <= p.tilt_limit)
        and abs(x[PHI]) <= p.excursion_limit
        and abs(x[PHI_DOT]) <= p.speed_limit
    )


@compiled
def shape(kind: int, phase: float) -> float:
    """Value at ``phase`` [rad], -1 to 1."""
    if kind == STEPS:
        return 1.0 if phase < np.pi else -1.0
    if kind == SINE:
        return np.sin(phase)
    return multisine(phase) / MULTISINE_PEAK


@compiled
def multisine(phase: float) -> float:
    """Sum of the harmonics, with Schroeder's phases (1970), which keep the peak low."""
    total = 0.0
    for k in range(1, HARMONICS + 1):
        total += np.sin(k * phase - np.pi * k * (k - 1) / HARMONICS)
    return total
