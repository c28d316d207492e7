"""Finds the time of a table's rows, in seconds."""

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_recordings.cleaning import LARGEST_UNORDERED_PART
from furuta_recordings.csv_columns import DATE, DAY_TIME, INSTANT, Table
from furuta_recordings.readers.columns import (
    TIME_UNITS,
    column,
    in_si,
    listed,
    unit_of,
    values_of,
)
from furuta_recordings.recording import Recording

# Names of a column with the time; `stamp` alone is one too.
TIME_WORDS = ("time", "timestamp", "t", "stamp", "date", "datetime", "zeit")
# Names of a column with the time since the row before.
STEP_WORDS = {
    ("dt",),
    ("delta", "t"),
    ("delta", "time"),
    ("time", "step"),
    ("step",),
    ("timestep",),
}
USUAL = "__time, time, timestamp, t, time_ms, millis, `Time [s]`"
# Smallest time since 1970 in each unit: that of the year 2001 in ns, µs and ms.
EPOCHS = {1e18: 1e-9, 1e15: 1e-6, 1e12: 1e-3}
# Median interval [s] from which a time cannot be in seconds.
LONGEST_INTERVAL = 0.5
# Sizes of counters of 16 and 32 bits of ms or µs, also in s or ms; of a day and an hour [s].
SIZES = (2.0**32, 2.0**16, 2.0**32 * 1e-3, 2.0**32 * 1e-6, 2.0**16 * 1e-3, 86400.0, 3600.0)
# Longest step at an overflow, in median steps.
LONGEST_STEP = 20.0
# Median interval and time from first to last [s] that no log has.
SHORTEST_INTERVAL, LONGEST_SPAN = 1e-7, 1e12


def clock_column(
    table: Table,
    wanted: str | None,
    remedy: str = "name it with --time",
    beside: str = "",
) -> str:
    """The column with the time of every row: the one ``wanted``, or one with a usual name.

    In a file with several structs it is the one in the struct of the column ``beside`` it.
    """
    columns = table.columns
    _join_seconds_and_nanoseconds(columns)
    words = {name: column(name).words for name in columns}
    if wanted is not None:
        given = column(wanted).words
        matching = [n for n in columns if n == wanted] or [n for n in columns if words[n] == given]
    else:
        matching = [n for n in columns if len(words[n]) == 1 and words[n][0] in TIME_WORDS]
        matching.sort(key=lambda name: words[name] == ("date",))
        own = column(beside).words[:-1]
        matching = matching or [
            n for n in columns if (*words[n],) in {(*own, w) for w in TIME_WORDS}
        ]
        matching = matching or [n for n in columns if words[n][-1:] == ("stamp",)]
        matching = matching or [n for n in columns if words[n] in STEP_WORDS]
    if not matching:
        raise ParameterError(
            f"{table.path}: no column with the time"
            + (f" {wanted}" if wanted else f", such as {USUAL}; {remedy}")
            + f"; it has {listed(table)}"
        )
    return _with_date(table, matching, remedy)


def _with_date(table: Table, matching: list[str], remedy: str) -> str:
    """The first of the columns; a date and a time of day become one."""
    dates = [name for name in matching if unit_of(table, name) == DATE]
    others = [name for name in matching if name not in dates]
    if not dates or (others and unit_of(table, others[0]) != DAY_TIME):
        return others[0]
    clocks = others[:1] or [n for n in table.columns if unit_of(table, n) == DAY_TIME]
    if len(clocks) != 1:
        raise ParameterError(
            f"{table.path}: column {dates[0]} holds dates, but no column with the time of day is "
            f"named time: {remedy}; it has {listed(table)}"
        )
    joined = f"{dates[0]} and {clocks[0]}"
    table.columns[joined] = values_of(table, dates[0]) + values_of(table, clocks[0])
    table.units[joined] = INSTANT
    return joined


def _join_seconds_and_nanoseconds(columns: dict[str, np.ndarray]) -> None:
    """Add a column X/stamp for columns X/stamp/sec and X/stamp/nanosec, in place."""
    for name in list(columns):
        seconds = name.removesuffix("nanosec") + "sec"
        if column(name).words[-2:] == ("stamp", "nanosec") and seconds in columns:
            columns[name[: -len("/nanosec")]] = columns[seconds] + 1e-9 * columns[name]


def stamp_column(table: Table, angle: str) -> str | None:
    """The stamp of the message that the column ``angle`` belongs to; None if it has none."""
    message = column(angle).words
    best, longest = None, -1
    for name in table.columns:
        words = column(name).words
        if words[-1:] != ("stamp",):
            continue
        own = words[:-2] if words[-2:-1] == ("header",) else words[:-1]
        if message[: len(own)] == own and len(own) > longest:
            best, longest = name, len(own)
    return best


def seconds(table: Table, name: str) -> tuple[np.ndarray, str]:
    """The times in a column [s], and a finding if they come from a counter that overflows.

    They are in the unit of the column or, since 1970, in that of their size.
    """
    times, size = continued(values_of(table, name))
    finding = f"column {name} begins anew after every {size:.10g}: continued" if size else ""
    if _holds_steps(times, name):
        times = np.cumsum(np.nan_to_num(times))
        finding = f"column {name} holds the time since the row before: summed"
    known = times[np.isfinite(times)]
    if not len(known):
        raise ParameterError(f"{table.path}: no time in column {name}")
    if unit_of(table, name):
        return in_si(table._replace(columns={name: times}), name, TIME_UNITS), finding
    typical = float(np.median(np.abs(known)))
    within = next((word for word in column(name).words if word in ("ms", "us", "ns")), "s")
    scale = next((s for least, s in EPOCHS.items() if typical > least), TIME_UNITS[within])
    steps = np.diff(known, append=known[-1])
    interval = scale * float(np.median(np.abs(steps)))
    # The order of rows in disorder is refused later, where it matters.
    if interval > LONGEST_INTERVAL and np.mean(steps < 0.0) < LARGEST_UNORDERED_PART:
        raise ParameterError(
            f"{table.path}: the median interval in column {name} is {interval:g} s; if it is not "
            "in seconds, add its unit to the name, as in time_ms"
        )
    return scale * times, finding


def _holds_steps(times: np.ndarray, name: str) -> bool:
    """Whether times (n,) are those since the row before: all alike, or named so and above 0."""
    known = times[np.isfinite(times)]
    alike = len(known) > 1 and known[0] > 0.0 and bool(np.all(known == known[0]))
    return alike or (column(name).words in STEP_WORDS and bool(np.all(known >= 0.0)))


def continued(times: np.ndarray) -> tuple[np.ndarray, float]:
    """Times (n,) of a counter or clock without its overflows, and the size of the counter, or 0.

    At an overflow the time steps back by the size of a counter, but for a usual interval.
    """
    known = np.isfinite(times)
    steps = np.diff(times[known])
    if not np.any(steps < 0.0) or not np.any(steps > 0.0):
        return times, 0.0
    longest = LONGEST_STEP * float(np.median(steps[steps > 0.0]))
    over = {size: (steps + size > 0.0) & (steps + size < longest) & (steps < 0.0) for size in SIZES}
    size = max(SIZES, key=lambda size: np.sum(over[size]))
    if not np.any(over[size]):
        return times, 0.0
    result = times.copy()
    result[known] += size * np.concatenate(([0], np.cumsum(over[size])))
    return result, size


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
