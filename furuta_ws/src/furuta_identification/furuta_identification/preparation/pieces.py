"""A log that stops in between, or holds several runs one after the other, cut where it does."""

from __future__ import annotations

import itertools

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

# Time [s] without a sample, and step back in time, from which the motion before tells nothing of
# the motion after.
PAUSE = 0.5
# Shortest piece [s] and fewest samples worth a fit.
SHORTEST = 1.5
FEWEST = 100


def pieces(recording: Recording) -> tuple[list[Recording], list[str]]:
    """The recording's pieces, itself if it is whole; and what was found."""
    time = recording.time
    steps = np.diff(time)
    cuts = np.flatnonzero((steps > PAUSE) | (steps < -PAUSE)) + 1
    if not len(cuts):
        return [recording], []
    bounds = [0, *(int(cut) for cut in cuts), len(time)]
    # Commands come in the order of the log, as samples do; theirs are cut in the same places.
    command_cuts = _command_cuts(recording, cuts)
    found = []
    for k, (first, end) in enumerate(itertools.pairwise(bounds)):
        own = slice(command_cuts[k], command_cuts[k + 1])
        piece = recording._replace(
            name=f"{recording.name} ({k + 1})",
            time=time[first:end],
            measured=recording.measured[first:end],
            command_time=recording.command_time[own],
            command=recording.command[own],
        )
        if len(piece.time) >= FEWEST and np.ptp(piece.time) >= SHORTEST and len(piece.command):
            found.append(piece)
    told = (
        f"{recording.name}: stops or begins anew {len(cuts)} times: {len(found)} of "
        f"{len(bounds) - 1} pieces used, those of {SHORTEST:g} s and more with a command"
    )
    if not found:
        raise ParameterError(told)
    return found, [told]


def _command_cuts(recording: Recording, cuts: np.ndarray) -> list[int]:
    """Where the commands of each piece begin, and the end."""
    time, command_time = recording.time, recording.command_time
    result = [0]
    for cut in cuts:
        before, after = time[cut - 1], time[cut]
        rest = command_time[result[-1] :]
        if after > before:
            # What was in force before the pause may be another run's: none is taken along.
            beyond = np.flatnonzero(rest > after)
        else:
            beyond = np.flatnonzero(np.diff(rest, prepend=rest[:1]) < -PAUSE)
        result.append(result[-1] + int(beyond[0]) if len(beyond) else len(command_time))
    return [*result, len(command_time)]
