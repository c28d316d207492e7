"""Finds the time of a table's rows, in seconds."""

from pathlib import Path

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.readers.columns import TIME_UNITS, Columns, column, in_si
from furuta_recordings.recording import Recording

# Names of a column with the time; `stamp` alone is one too.
TIME_WORDS = ("time", "timestamp", "t", "stamp", "date", "datetime")
USUAL = "__time, time, timestamp, t, time_ms, millis, `Time [s]`"
# Smallest time since 1970 in each unit: that of the year 2001 in ns, µs and ms.
EPOCHS = {1e18: 1e-9, 1e15: 1e-6, 1e12: 1e-3}
# Median interval [s] from which a time cannot be in seconds.
LONGEST_INTERVAL = 0.5
# Median interval and time from first to last [s] that no log has.
SHORTEST_INTERVAL, LONGEST_SPAN = 1e-7, 1e12


def clock_column(path: Path, columns: Columns, wanted: str | None) -> str:
    """The column with the time of every row: the one ``wanted``, or one with a usual name."""
    _join_seconds_and_nanoseconds(columns)
    words = {name: column(name).words for name in columns}
    if wanted is not None:
        given = column(wanted).words
        matching = [n for n in columns if n == wanted] or [n for n in columns if words[n] == given]
    else:
        matching = [n for n in columns if len(words[n]) == 1 and words[n][0] in TIME_WORDS]
        matching = matching or [n for n in columns if words[n][-1:] == ("stamp",)]
    if not matching:
        raise ParameterError(
            f"{path}: no column with the time"
            + (f" {wanted}" if wanted else f", such as {USUAL}; name it with --time")
            + f"; it has {', '.join(columns)}"
        )
    return matching[0]


def _join_seconds_and_nanoseconds(columns: Columns) -> None:
    """Add a column X/stamp for columns X/stamp/sec and X/stamp/nanosec, in place."""
    for name in list(columns):
        seconds = name.removesuffix("nanosec") + "sec"
        if column(name).words[-2:] == ("stamp", "nanosec") and seconds in columns:
            columns[name[: -len("/nanosec")]] = columns[seconds] + 1e-9 * columns[name]


def stamp_column(columns: Columns, angle: str) -> str | None:
    """The stamp of the message that the column ``angle`` belongs to; None if it has none."""
    message = column(angle).words
    best, longest = None, -1
    for name in columns:
        words = column(name).words
        if words[-1:] != ("stamp",):
            continue
        own = words[:-2] if words[-2:-1] == ("header",) else words[:-1]
        if message[: len(own)] == own and len(own) > longest:
            best, longest = name, len(own)
    return best


def seconds(path: Path, columns: Columns, name: str) -> np.ndarray:
    """The times in a column [s]; in the unit of its name or, since 1970, of their size."""
    if column(name).unit:
        return in_si(path, columns, name, TIME_UNITS)
    times = columns[name]
    known = times[np.isfinite(times)]
    if not len(known):
        raise ParameterError(f"{path}: no time in column {name}; name another one with --time")
    size = float(np.median(np.abs(known)))
    scale = next((scale for least, scale in EPOCHS.items() if size > least), 1.0)
    interval = scale * float(np.median(np.abs(np.diff(known)))) if len(known) > 1 else 0.0
    if interval > LONGEST_INTERVAL:
        raise ParameterError(
            f"{path}: the median interval in column {name} is {interval:g} s; if it is not in "
            "seconds, add its unit to the name, as in time_ms"
        )
    return scale * times


def with_usable_times(recording: Recording) -> Recording:
    """The recording, if its times can be computed with: a window of 1e-300 s has no samples."""
    times = recording.time[np.isfinite(recording.time)]
    span = float(np.ptp(times)) if len(times) > 1 else 0.0
    if span > LONGEST_SPAN or 0.0 < recording.interval < SHORTEST_INTERVAL:
        raise ParameterError(
            f"{recording.name}: {len(times)} times over {span:.3g} s, with a median interval of "
            f"{recording.interval:.3g} s; correct the times or their unit"
        )
    return recording
