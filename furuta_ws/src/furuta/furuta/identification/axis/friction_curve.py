"""Friction over the speed of an identified axis, and its measured and fitted position."""

from __future__ import annotations

import numpy as np

from furuta.identification.axis.balance import ROUNDING, has_samples, torque_columns
from furuta.identification.axis.effects import waves_of
from furuta.identification.axis.fit import AxisFit
from furuta.identification.axis.motion import level
from furuta.identification.axis.segments import Smoothed, position_noise, segmented, smoothed
from furuta.identification.bodies.axis import Axis, model_of
from furuta.identification.least_squares import Problem, evaluated, fit
from furuta.identification.regression.windows import Windows
from furuta.identification.result.friction_curve import Followed, FrictionCurve, friction_curve
from furuta.identification.unknowns import Unknowns, field_of
from furuta_recordings.recording import Recording

# What is subtracted from the torque: the rest is friction, with the offset.
NOT_FRICTION = ("inertia", "delay", "gravity_sin", "gravity_cos", "spring", "drift", "cos", "sin")
# Shortest bump, in windows over which the position is smoothed, and longest one [s]; noise of the
# inertia's torque that is small, in the usual torque.
SHORTEST, LONGEST, SMALL = 1.5, 0.3, 0.05
# Distance of the windows, in their length.
APART = 0.1
# Standard deviations of a speed from which the axis slides.
SLIDES = 2.0


def axis_friction(result: AxisFit) -> FrictionCurve:
    """Friction and offset of the first recording over speed.

    Friction is measured as the torque minus what accelerates the axis and what acts on it by
    position, where it slides in one direction. The part that grows with the torque of the drive is
    left out.
    """
    unknowns = result.fit.unknowns
    shown = [_shown(result, number) for number in range(len(result.recordings))]
    speeds, friction, overlaps = zip(*shown, strict=True)

    def law(vector: np.ndarray, speed: np.ndarray) -> np.ndarray:
        m = model_of(unknowns.changed(result.fit.values, vector))
        side = np.sign(speed)
        levels = np.array([level(abs(each), 0.0, m) for each in speed])
        viscous = (m.viscous + side * m.viscous_difference) * speed
        total: np.ndarray = (1.0 + side * m.asymmetry) * levels * side + viscous + m.offsets[0]
        return total

    position, torque = result.recordings[0].units
    curve = friction_curve(
        law,
        unknowns.vector(result.fit.values),
        result.covariance,
        (np.concatenate(speeds), np.concatenate(friction)),
        max(overlaps),
        (f"{position}/s", torque),
    )
    return curve._replace(shown="friction and offset")


def _shown(result: AxisFit, number: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Speeds and friction (n,) that a recording shows, and how many of them overlap."""
    recording, values = result.recordings[number], result.fit.values
    part = smoothed(recording)
    windows = _windows(recording, part, values["inertia"])
    columns = torque_columns(windows, recording, part, waves_of(result.fit), 1.0)
    columns["load_friction"] = _friction_of_load(result, windows, recording, columns["alpha0"])
    friction = columns["torque"].copy()
    for key in columns.keys() & values.keys():
        if field_of(key) in (*NOT_FRICTION, "load_friction"):
            friction -= values[key] * columns[key]
    friction = friction - values["offset", number] + values["offset", 0]
    slow = SLIDES * np.sqrt(12.0) * position_noise(recording) / part.window
    slides = np.where(np.abs(part.speed) > slow, np.sign(part.speed), 0.0)
    slides *= has_samples(recording, part.time)
    whole = np.abs(windows.mean(slides)) > 1.0 - ROUNDING
    return columns["viscous"][whole], friction[whole], 0.5 / APART


def _windows(recording: Recording, part: Smoothed, inertia: float) -> Windows:
    """The shortest windows over which the noise of the position hardly changes the friction."""
    length = SHORTEST * part.window
    allowed = SMALL * float(np.std(part.torque))
    while True:
        windows = Windows(part.time, length, APART)
        noise = inertia * position_noise(recording) * windows.noise(2)
        if noise < allowed or length >= LONGEST:
            return windows
        length = min(1.3 * length, LONGEST)


def _friction_of_load(
    result: AxisFit, windows: Windows, recording: Recording, side: np.ndarray
) -> np.ndarray:
    """Friction per ``load_friction``: the size of the drive's torque against the motion."""
    size = np.abs(recording.commanded_at(smoothed(recording).time))
    asymmetry = result.fit.values["asymmetry"]
    against: np.ndarray = (side + asymmetry) * windows.mean(size)
    return against


def axis_followed(result: AxisFit) -> Followed:
    """Position of all recordings, measured and as the segments of the fit follow it.

    If the torque was fitted, only the first states of the segments follow the position.
    """
    ready = list(result.recordings)
    cut, values, first = segmented(ready), result.fit.values, result.fit.state.first
    problem = Problem(Axis(), cut, Unknowns(()))
    fits_motion = first.shape == cut.first.shape
    state = evaluated(problem, values, first) if fits_motion else fit(problem, values).state
    fitted = cut.measured[:, 0] - state.residuals[:, 0] / cut.weight[:, 0]
    steps = np.diff(cut.time, prepend=cut.time[0])
    time = np.cumsum(np.where(np.repeat(np.diff(cut.of, prepend=0), cut.lengths) > 0, 0.0, steps))
    ends = cut.bounds[1:-1]
    return Followed(
        np.insert(time, ends, np.nan),
        np.insert(cut.measured[:, 0], ends, np.nan),
        np.insert(fitted, ends, np.nan),
        ready[0].units[0],
    )
