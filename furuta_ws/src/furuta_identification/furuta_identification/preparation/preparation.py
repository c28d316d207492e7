"""What must be known of a recording before anything is fitted: orientation, zero, missing command.

Nothing here is assumed in silence: each function returns what it found in words.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.preparation.consistency import in_radians, with_true_speeds
from furuta_identification.regression.momentum import arm_misfits, ratios
from furuta_identification.regression.speeds import speed_lag, with_speeds
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import Recording

# Part of the largest arm speed, and speed [rad/s], beyond which the arm moves.
MOVING = 0.03
SLOWEST = 0.05
# Samples in a row that make a motion.
SAMPLES = 5
# Interval [s] between commands that are set and held rather than streamed.
HELD = 0.1
# Time [s] before the first command that motion must begin for that command to be the second, of
# those streamed; of those held so little may be a delay.
EARLY = 0.02
# Time [s] that a command is taken to have been in force when a log begins in motion.
BEFORE = 1.0
# Commands of so few sizes are steps, of which a missing one was another; and how much worse than
# with another one the motion may agree with the usual one.
FEW = 10
AS_GOOD = 1.2
LONGEST_GAP = 10.0
# Largest command [V] of a motor of this size.
LARGEST_COMMAND = 100.0
ZEROS = ("auto", "upright", "hanging")


class Options(NamedTuple):
    """What the user says.

    The pendulum's ``zero`` (auto, upright, hanging), the stretch [s] or None, the ``angles``' unit
    (auto, rad, deg), and how many volts one of the command is.
    """

    zero: str = "auto"
    window: float | None = None
    angles: str = "auto"
    command_scale: float = 1.0


def prepare(recording: Recording, options: Options) -> tuple[Recording, list[str]]:
    """Clean, turn upright, complete; and what was found on the way."""
    scaled = recording._replace(command=options.command_scale * recording.command)
    recording, findings = checked(scaled)
    for step in (
        lambda each: in_radians(each, options.angles),
        with_true_speeds,
        with_first_command,
        lambda each: oriented(each, options.zero),
    ):
        recording, found = step(recording)
        findings += found
    return recording, [f"{recording.name}: {each}" for each in findings]


def checked(recording: Recording) -> tuple[Recording, list[str]]:
    """The recording without unusable samples; :class:`ParameterError` where too little is left."""
    time, measured = recording.time, recording.measured
    findings = []
    for angle, what in ((PHI, "arm"), (THETA, "pendulum")):
        if not np.any(np.isfinite(measured[:, angle])):
            raise ParameterError(f"{recording.name}: no angle of the {what}")
    usable = np.isfinite(measured[:, PHI]) & np.isfinite(measured[:, THETA]) & np.isfinite(time)
    usable[1:] &= np.diff(np.maximum.accumulate(np.nan_to_num(time, nan=-np.inf))) > 0.0
    if np.sum(usable) < 100:
        raise ParameterError(
            f"{recording.name}: {np.sum(usable)} usable samples of {len(time)}, at least 100 needed"
        )
    if not np.all(usable):
        findings.append(
            f"{np.sum(~usable)} of {len(time)} samples dropped (no angle, or time went back)"
        )
    recording = recording._replace(time=time[usable], measured=measured[usable].copy())
    given = np.isfinite(recording.command) & np.isfinite(recording.command_time)
    recording = recording._replace(
        command=recording.command[given], command_time=recording.command_time[given]
    )
    if not np.any(given):
        raise ParameterError(
            f"{recording.name}: no command in it; name its topic or column with --command"
        )
    largest = float(np.max(np.abs(recording.command)))
    if largest > LARGEST_COMMAND:
        raise ParameterError(
            f"{recording.name}: commands up to {largest:g} are no volts; say what one is with "
            "--command-scale (0.001 for millivolts)"
        )
    for speed in (PHI_DOT, THETA_DOT):
        # A speed that is missing now and then is bridged; one that never comes stays NaN.
        here = np.isfinite(recording.measured[:, speed])
        if np.any(here) and not np.all(here):
            recording.measured[~here, speed] = np.interp(
                recording.time[~here], recording.time[here], recording.measured[here, speed]
            )
    gap = float(np.max(np.diff(recording.time)))
    if gap > LONGEST_GAP * recording.interval:
        findings.append(
            f"dropout of {gap:.3f} s; the usual interval is {recording.interval * 1e3:.2f} ms"
        )
    return recording, findings


def oriented(recording: Recording, zero: str) -> tuple[Recording, list[str]]:
    """The recording with θ = 0 upright and θ̇ > 0 the way (1) counts it.

    The pendulum's equation tells both: with the wrong zero gravity has the wrong sign, with the
    wrong direction the coupling.
    """
    speeds = with_speeds(recording, speed_lag(recording))
    inertia, coupling = ratios(speeds)
    found = "upright" if inertia > 0.0 else "hanging"
    if zero not in ("auto", found):
        raise ParameterError(
            f"{recording.name}: the pendulum's zero is given as {zero}, but it moves as if its "
            f"zero were {found}"
        )
    direction = -1.0 if coupling < 0.0 else 1.0
    turned = recording.reoriented(np.pi if found == "hanging" else 0.0, direction, 1.0)
    turns = 2.0 * np.pi * np.round(np.mean(turned.measured[:, THETA]) / (2.0 * np.pi))
    turned.measured[:, THETA] -= turns
    formula = (
        ("π " if found == "hanging" else "") + ("− " if direction < 0.0 else "+ ") + "measured"
    )
    known = "as given" if zero == found else "found"
    return turned, [f"pendulum angle 0 is {found} ({known}): θ = {formula.removeprefix('+ ')}"]


def with_first_command(recording: Recording) -> tuple[Recording, list[str]]:
    """Adds a first command that the log lacks: the arm moves before there is any."""
    onset = _onset(recording)
    if onset is not None and onset <= recording.time[SAMPLES]:
        return _in_motion(recording)
    first = recording.command_time[0]
    intervals = np.diff(recording.command_time)
    period = float(np.median(intervals)) if len(intervals) else np.inf
    early = HELD if period > HELD else EARLY
    if onset is None or onset >= first - early or recording.command[0] == 0.0:
        return recording, []
    start, why = onset, "when the arm begins to move"
    if HELD < period < np.inf:
        candidate = first - period * max(1, round((first - onset) / period))
        if abs(candidate - onset) < HELD:
            start, why = candidate, f"one interval of {period:.3f} s earlier"
    value = _likeliest(recording, start)
    return _with_command(recording, start, value), [
        f"the first command is missing: the arm moves at {onset:.3f} s, the first command "
        f"({recording.command[0]:g} V) is of {first:.3f} s; taken to have been {value:g} V, set "
        f"{why}, at {start:.3f} s"
    ]


def _with_command(recording: Recording, time: float, value: float) -> Recording:
    """The recording with one more command before the others."""
    return recording._replace(
        command_time=np.append(time, recording.command_time),
        command=np.append(value, recording.command),
    )


def _likeliest(recording: Recording, time: float) -> float:
    """The command at ``time`` [s] by which the arm's equation holds best: one of the others [V]."""
    own = float(recording.command[0])
    others = np.unique(recording.command)
    candidates = [own, -own, *(float(u) for u in others if len(others) <= FEW)]
    with_all = with_speeds(recording, speed_lag(recording))
    misfits = [
        float(arm_misfits(_with_command(with_all, time, u), np.zeros(1))[0]) for u in candidates
    ]
    best = int(np.argmin(misfits))
    return own if misfits[0] <= AS_GOOD * misfits[best] else candidates[best]


def _in_motion(recording: Recording) -> tuple[Recording, list[str]]:
    """The part with commands; before the first one the same was in force."""
    first = recording.command_time[0]
    kept = recording.between(first - EARLY, np.inf)
    if len(kept.time) < 100:
        raise ParameterError(f"{recording.name}: next to nothing after the first command")
    held = _with_command(kept, first - BEFORE, float(recording.command[0]))
    late = first > recording.time[0] + EARLY
    return held, [
        "in motion from the start: its state there is fitted too"
        + (f", from the first command at {first:.3f} s on" if late else "")
    ]


def _onset(recording: Recording) -> float | None:
    """When the arm begins to move [s], if it ever does."""
    speed = np.abs(with_speeds(recording, 0.0).measured[:, PHI_DOT])
    moving = speed > max(SLOWEST, MOVING * float(np.max(speed)))
    run = np.convolve(moving, np.ones(SAMPLES), "valid") == SAMPLES
    return float(recording.time[np.argmax(run)]) if np.any(run) else None
