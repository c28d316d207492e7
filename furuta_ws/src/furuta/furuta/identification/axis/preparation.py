"""The usable part of a recording of a joint, and the units of what is found."""

from __future__ import annotations

import numpy as np

from furuta.identification.errors import quantisation_step
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording

# Fewest counts of the sensor over which the axis must move.
COUNTS = 8.0
# Shortest interval [s] between samples that is fitted.
THINNED = 1e-3


def prepared(recording: Recording) -> tuple[Recording, float]:
    """The usable part, with time 0 in its middle, and that time [s]; raises if the axis rests."""
    ready = usable_part(recording)
    middle = 0.5 * float(ready.time[0] + ready.time[-1])
    command_time = ready.command_time - middle
    return ready._replace(time=ready.time - middle, command_time=command_time), middle


def usable_part(recording: Recording) -> Recording:
    """The usable part, at no more than 2 kHz.

    Raises:
        ParameterError: The axis hardly moves.
    """
    if len(recording.command) and np.ptp(recording.command) == 0.0:
        constant = recording.command[0] + 0.0  # no -0
        raise ParameterError(
            f"{recording.name}: the torque is {constant:g} throughout; name another column with "
            "--command"
        )
    travel, count = (f(recording.measured[:, PHI]) for f in (_travel, quantisation_step))
    if not travel >= COUNTS * count > 0.0:
        raise ParameterError(
            f"{recording.name}: the axis moves by {travel:g}, which is less than {COUNTS:g} counts "
            f"of {count:g} of its sensor; record a larger motion"
        )
    return _thinned(cleaned(recording, joints=(PHI,)))


def _thinned(recording: Recording) -> Recording:
    """A recording at 1 to 2 kHz of one that was faster, with the mean of its commands between."""
    every = int(THINNED / recording.interval) if recording.interval else 1
    together = np.array_equal(recording.time, recording.command_time)
    if every < 2 or not together:
        return recording
    starts = np.arange(0, len(recording.time), every)
    means = np.add.reduceat(recording.command, starts)
    thinned = recording._replace(
        time=recording.time[starts],
        measured=recording.measured[starts],
        command_time=recording.time[starts],
        command=means / np.diff(np.append(starts, len(recording.time))),
    )
    rate = 1e-3 / recording.interval
    return thinned.noting(f"{rate:.3g} kHz: every {every}th position, and the mean of its torques")


def unit_of(name: str, units: tuple[str, str]) -> str:
    """The unit of a value, from those of position and torque; empty for a number."""
    position, torque = units
    if units == ("rad", "N m"):
        inertia = "kg m²"
    elif units == ("m", "N"):
        inertia = "kg"
    else:
        inertia = f"{torque} s²/{position}"
    known = {
        "inertia": inertia,
        "viscous": f"{torque} s/{position}",
        "viscous_difference": f"{torque} s/{position}",
        "drag": f"{torque} s²/{position}²",
        "spring": f"{torque}/{position}",
        "drift": f"{torque}/s",
        "delay": "s",
        "stribeck_velocity": f"{position}/s",
        "asymmetry": "",
        "load_friction": "",
        "gravity_friction": "",
    }
    return known.get(name, torque)


def _travel(position: np.ndarray) -> float:
    known = position[np.isfinite(position)]
    return float(np.ptp(known)) if len(known) else 0.0
