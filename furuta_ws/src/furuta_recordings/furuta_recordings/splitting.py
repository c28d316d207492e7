"""Splits a log that pauses, or that contains several runs one after the other."""

import itertools

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.recording import Recording

# Time [s] without a sample that separates two runs: the motion before does not determine the motion
# after. Readers put runs of which the clock begins anew one after the other, further apart.
PAUSE = 0.5
# Shortest run [s] and fewest samples worth a fit.
SHORTEST_RUN = 1.5
FEWEST_SAMPLES = 100
# Excerpts of a long run, and their samples. More make a fit slower, not much better.
EXCERPTS, EXCERPT = 6, 2000
# Shortest interval [s] between the samples of an excerpt.
SHORTEST_INTERVAL = 1e-3
# Part of the usual travel of the arm below which an excerpt is not used.
MOVING_PART = 0.3


def split_into_runs(recording: Recording) -> list[Recording]:
    """The runs in a recording, usually only itself."""
    cuts = np.flatnonzero(np.diff(recording.time) > PAUSE) + 1
    if not len(cuts):
        return [recording]
    runs = _runs(recording, cuts)
    usable = [run for run in runs if _is_usable(run)]
    recording = recording.noting(
        f"pauses or restarts {len(cuts)} times: {len(usable)} of {len(runs)} runs used, those of "
        f"at least {SHORTEST_RUN:g} s with a command"
    )
    if not usable:
        raise ParameterError(recording.findings[-1])
    return [run._replace(findings=recording.findings) for run in usable]


def _runs(recording: Recording, cuts: np.ndarray) -> list[Recording]:
    """The recording's parts between the cuts, commands included."""
    bounds = [0, *(int(cut) for cut in cuts), len(recording.time)]
    samples = [slice(*pair) for pair in itertools.pairwise(bounds)]
    commands = [slice(*pair) for pair in itertools.pairwise(_command_bounds(recording, cuts))]
    return [
        recording._replace(
            name=f"{recording.name} ({number})",
            time=recording.time[rows],
            measured=recording.measured[rows],
            command_time=recording.command_time[own],
            command=recording.command[own],
        )
        for number, (rows, own) in enumerate(zip(samples, commands, strict=True), 1)
    ]


def _is_usable(run: Recording) -> bool:
    long_enough = len(run.time) >= FEWEST_SAMPLES and np.ptp(run.time) >= SHORTEST_RUN
    return bool(long_enough and len(run.command))


def _command_bounds(recording: Recording, cuts: np.ndarray) -> list[int]:
    """Where the commands of each run start, and the end."""
    # The command before a pause may belong to another run: none is carried over.
    bounds = np.searchsorted(recording.command_time, recording.time[cuts])
    return [0, *map(int, bounds), len(recording.command_time)]


def excerpts_of(run: Recording, most_samples: int) -> list[Recording]:
    """Excerpts evenly spread over the motion of a run with more samples than that."""
    n = len(run.time)
    if n <= most_samples:
        return [run]
    every = max(1, int(SHORTEST_INTERVAL / (run.interval or 1.0) + 1e-6))
    size = min(EXCERPT * every, n)
    parts = [slice(start, start + size, every) for start in range(0, n - size + 1, size)]
    parts = _moving(run, parts)
    spread = np.linspace(0, len(parts) - 1, min(EXCERPTS, len(parts))).round().astype(int)
    thinned = f", one sample in {every}" if every > 1 else ""
    length = float(np.ptp(run.time[parts[spread[0]]]))
    run = run.noting(
        f"{n} samples: fitted in {len(spread)} excerpts of {length:.1f} s of {run.duration:.1f} s"
        f"{thinned}"
    )
    return [_excerpt(run, parts[k]) for k in spread]


def _moving(run: Recording, parts: list[slice]) -> list[slice]:
    """The parts in which the arm moves about as far as usual."""
    travels = np.array([np.nanstd(run.measured[part, PHI]) for part in parts])
    usual = float(np.nanmedian(travels))
    return [p for p, travel in zip(parts, travels, strict=True) if travel >= MOVING_PART * usual]


def _excerpt(run: Recording, rows: slice) -> Recording:
    """The samples ``rows`` with the commands that hold during them."""
    time = run.time[rows]
    first = max(int(np.searchsorted(run.command_time, time[0], "right")) - 1, 0)
    own = slice(first, int(np.searchsorted(run.command_time, time[-1], "right")))
    return run._replace(
        name=f"{run.name} from {time[0]:.1f} s",
        time=time,
        measured=run.measured[rows],
        command_time=run.command_time[own],
        command=run.command[own],
    )
