"""A recorded session of the graph, and its recomputation with recorded or other parameters."""

from __future__ import annotations

from array import array
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.state import SIGNALS
from furuta_recordings.bags.bag import Bag, last_part, signals
from furuta_recordings.bags.bag_files import parameter_file_of
from furuta_ros.time_stamps import NANOSECONDS, stamp_nanoseconds
from furuta_ros.topic_names import (
    COMMAND,
    FRICTION_ESTIMATE,
    JOINT_STATES,
    MEASUREMENT,
    PARAMETER_EVENTS,
)
from furuta_sim.settings.settings import (
    Settings,
    load_settings,
    loop,
    merge_settings,
    read_file,
)
from furuta_sim.simulation.recomputation import Recomputed, recompute

# Name of the topic on which parameter changes are recorded.
CHANGES = PARAMETER_EVENTS.strip("/")


class RecordedLoop(NamedTuple):
    """What a bag holds of the graph, one row per measurement.

    ``stamps`` (n,) [ns], ``measurement`` (n, 5). ``outputs`` are what the nodes computed, NaN where
    nothing was recorded. ``changes``: (sample, node, {parameter: value}) of parameters set.
    """

    stamps: np.ndarray
    measurement: np.ndarray
    outputs: Recomputed
    changes: list[tuple[int, str, dict[str, Any]]]

    @property
    def time(self) -> np.ndarray:
        """Time since the first sample (n,) [s]."""
        elapsed: np.ndarray = (self.stamps - self.stamps[0]) / NANOSECONDS
        return elapsed


def read_recorded_loop(bag: Path) -> RecordedLoop:
    """Read a bag of the graph, sample by sample."""
    with Bag(bag) as reader:
        namespaces = {
            c.topic.rpartition("/")[0]
            for c in reader.connections
            if last_part(c.topic) == MEASUREMENT
        }
        messages = _GraphMessages(namespaces)
        chosen = [c for c in reader.connections if last_part(c.topic) in messages.topics]
        for connection, _, message in reader.messages_in_memory(chosen):
            messages.add(last_part(connection.topic), message)
    if not messages.samples:
        raise ParameterError(f"{bag}: no message on {MEASUREMENT}, nothing to recompute")
    return messages.as_loop()


class _GraphMessages:
    """Collects the messages of the graph in these namespaces, in the order of the recording."""

    def __init__(self, namespaces: set[str]) -> None:
        self._namespaces = namespaces
        self.samples: dict[int, int] = {}  # numbers of the samples by the stamp [ns]
        self._measured = array("d")
        self._estimated, self._estimated_at = array("d"), array("q")
        self._floats = {FRICTION_ESTIMATE: array("d"), COMMAND: array("d")}
        self._changes: list[tuple[int, str, dict[str, Any]]] = []
        self.topics = {MEASUREMENT, JOINT_STATES, CHANGES, *self._floats}

    def add(self, topic: str, message: Any) -> None:
        """Add a message of ``topic``; repeated measurements are ignored."""
        if topic == CHANGES:
            namespace, _, node = message.node.rpartition("/")
            if namespace in self._namespaces:  # not a change of another graph
                given = {p.name: _value(p.value) for p in message.changed_parameters}
                self._changes.append((len(self.samples), node, given))
        elif topic in self._floats:
            self._floats[topic].append(message.data)
        elif topic == JOINT_STATES:
            self._estimated_at.append(stamp_nanoseconds(message))
            self._estimated.extend(signals(message))
        elif (stamp := stamp_nanoseconds(message)) not in self.samples:
            self.samples[stamp] = len(self.samples)
            self._measured.extend(signals(message))

    def as_loop(self) -> RecordedLoop:
        """All messages, one row per measurement."""
        stamps = np.fromiter(self.samples, np.int64)
        n = len(stamps)
        estimates = np.full((n + 1, SIGNALS), np.nan)
        # Estimates without a measurement go to the last row, which is dropped.
        rows = [self.samples.get(stamp, n) for stamp in self._estimated_at]
        estimates[rows] = np.array(self._estimated).reshape(-1, SIGNALS)
        friction, command = (_padded(series, n) for series in self._floats.values())
        return RecordedLoop(
            stamps,
            np.array(self._measured).reshape(-1, SIGNALS),
            Recomputed(estimates[:n], friction, command),
            self._changes,
        )


def _padded(series: array[float], n: int) -> np.ndarray:
    """The first n values; missing ones are NaN."""
    padded = np.full(n, np.nan)
    padded[: min(n, len(series))] = series[:n]
    return padded


# Fields of a parameter's value by its type (rcl_interfaces/ParameterType).
_VALUES = {1: "bool_value", 2: "integer_value", 3: "double_value", 4: "string_value"}


def _value(value: Any) -> Any:
    if value.type == 0:
        return ()
    if value.type in _VALUES:
        return getattr(value, _VALUES[value.type])
    return tuple(map(float, value.double_array_value))


def recompute_bag(
    bag: Path, files: tuple[Path, ...], assignments: tuple[str, ...]
) -> tuple[RecordedLoop, Recomputed]:
    """Recompute a session with the recorded parameters; given ones take precedence."""
    recorded = read_recorded_loop(bag)
    file = parameter_file_of(bag)
    base = load_settings([], []) if file is None else read_file(file)
    # Defaults replace parameters that another version did not record.
    given = load_settings(files, assignments)
    loops = [(0, loop(merge_settings(base, given)))]
    for sample, node, changed in recorded.changes:
        if node in base:
            base = merge_settings(base, _settings_of(base, node, changed))
            loops.append((sample, loop(merge_settings(base, given))))
    return recorded, recompute(recorded.measurement, loops, recorded.stamps)


def _settings_of(settings: Settings, node: str, changed: dict[str, Any]) -> Settings:
    return {name: (changed if name == node else {}) for name in settings}


def compare(recorded: RecordedLoop, recomputed: Recomputed) -> dict[str, Any]:
    """Largest and rms difference of each series over the samples that were recorded."""
    result: dict[str, Any] = {"samples": len(recorded.time), "identical": True}
    for name in Recomputed._fields:
        result[name] = _compare_series(getattr(recorded.outputs, name), getattr(recomputed, name))
        result["identical"] &= result[name]["identical"]
    return result


def _compare_series(old: np.ndarray, new: np.ndarray) -> dict[str, Any]:
    known = np.isfinite(old)
    difference = (new - old)[known]
    return {
        "identical": bool(np.array_equal(new[known], old[known])),
        "compared": int(np.sum(known)),
        "largest_difference": float(np.max(np.abs(difference), initial=0.0)),
        "rms_difference": float(np.sqrt(np.mean(difference**2))) if len(difference) else 0.0,
    }
