"""Excitation signal, added to the command to make recordings more informative for identification.

Outside its limits of angle and speed the signal is zero and its phase is kept until the feedback
has brought arm and pendulum back. In mode ``open_loop`` it is the whole command, and the angle of
the pendulum does not limit it.
"""

from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.parameters import SELECTS, About
from furuta_model.state import PHI, PHI_DOT, THETA

TWO_PI = 2.0 * np.pi
# Number of harmonics of the multisine, all with the same amplitude.
HARMONICS = 8
# Largest value of the sum of the harmonics.
MULTISINE_PEAK = 3.781


KINDS = ("none", "steps", "sine", "multisine")
STEPS = KINDS.index("steps")
SINE = KINDS.index("sine")
MULTISINE = KINDS.index("multisine")


@compiled
def shape(kind: int, phase: float) -> float:
    """The signal, -1 to 1, at a phase [rad].

    The harmonics of the multisine have Schroeder phases (1970), which give a low peak.
    """
    if kind == STEPS:
        return 1.0 if phase < np.pi else -1.0
    if kind == SINE:
        return np.sin(phase)
    total = 0.0
    if kind == MULTISINE:
        for k in range(1, HARMONICS + 1):
            total += np.sin(k * phase - np.pi * k * (k - 1) / HARMONICS)
    return total / MULTISINE_PEAK


class ExcitationParameters(NamedTuple):
    """The excitation signal and its limits."""

    kind: Annotated[
        str,
        About(
            "signal added to the command for identification: steps up and down, a sine, or a "
            f"multisine of the first {HARMONICS} harmonics",
            choices=KINDS,
        ),
    ] = "none"
    amplitude: Annotated[float, About("amplitude of the signal", "V", 0.0, 1e3)] = 1.0
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
    """The signal as the compiled functions use it.

    ``on``: whether there is one. ``kind`` is an index of :data:`KINDS`, ``step`` the phase per
    sample [rad]. With ``any_tilt`` the angle of the pendulum does not limit the signal.
    """

    on: bool
    kind: Annotated[int, SELECTS]
    amplitude: float
    step: float
    tilt_limit: float
    excursion_limit: float
    speed_limit: float
    any_tilt: bool


def design_excitation(
    p: ExcitationParameters, sample_time: float, any_tilt: bool = False
) -> Excitation:
    """The signal that the parameters describe, for samples of ``sample_time`` [s]."""
    return Excitation(
        on=p.kind != "none",
        kind=KINDS.index(p.kind),
        amplitude=p.amplitude,
        step=TWO_PI * min(sample_time / p.period, 0.5),
        tilt_limit=p.tilt_limit,
        excursion_limit=p.excursion_limit,
        speed_limit=p.speed_limit,
        any_tilt=any_tilt,
    )


@inlined
def within_limits(x: np.ndarray, p: Excitation) -> bool:
    """Whether arm and pendulum in state ``x`` are within the limits."""
    return (
        (p.any_tilt or abs(x[THETA]) <= p.tilt_limit)
        and abs(x[PHI]) <= p.excursion_limit
        and abs(x[PHI_DOT]) <= p.speed_limit
    )
