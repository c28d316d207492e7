"""A recorded session computed again: the same numbers, or what another tuning would have made."""

from __future__ import annotations

from array import array
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from furuta_analysis.simulation.recomputation import Recomputed, recompute
from furuta_graph.settings import (
    Settings,
    load_settings,
    loop,
    merge_settings,
    read_file,
    with_current_parameter_names,
)
from furuta_model.parameters import ParameterError
from furuta_model.state import SIGNALS
from furuta_recordings.bags.bag import Bag, last_part, refuse_too_long, signals
from furuta_recordings.recorder_node import PARAMETER_EVENTS, PARAMETERS_FILE
from furuta_ros.messages import NANOSECONDS, stamp_nanoseconds
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, JOINT_STATES, MEASUREMENT


class RecordedLoop(NamedTuple):
    """What a bag holds of the graph, one row a measurement.

    ``time`` (n,) [s], ``measurement`` (n, 5); ``recorded`` what the nodes made of it, NaN where
    nothing was recorded; ``changes``: (sample, node, {parameter: value}) of parameters set.
    """

    time: np.ndarray
    measurement: np.ndarray
    recorded: Recomputed
    changes: list[tuple[int, str, dict[str, Any]]]


def read_recorded_loop(bag: Path) -> RecordedLoop:
    """Read a bag of the graph, sample by sample."""
    measured = array("d")
    samples: dict[int, int] = {}  # of the stamps of measurements
    estimated, estimated_at = array("d"), array("q")
    floats = {FRICTION_ESTIMATE.name: array("d"), COMMAND.name: array("d")}
    changes: list[tuple[int, str, dict[str, Any]]] = []
    with Bag(bag) as reader:
        wanted = {MEASUREMENT.name, JOINT_STATES.name, *floats, PARAMETER_EVENTS.name.strip("/")}
        chosen = [c for c in reader.connections if last_part(c.topic) in wanted]
        refuse_too_long(bag, chosen)
        namespaces = {
            c.topic.rpartition("/")[0] for c in chosen if last_part(c.topic) == MEASUREMENT.name
        }
        for connection, _, data in reader.messages(chosen):
            name = last_part(connection.topic)
            message: Any = reader.deserialize(data, connection.msgtype)
            if name == PARAMETER_EVENTS.name.strip("/"):
                namespace, _, node = message.node.rpartition("/")
                given = {each.name: _value(each.value) for each in message.changed_parameters}
                if namespace in namespaces:  # not a change of another graph
                    changes.append((len(samples), node, given))
            elif name in floats:
                floats[name].append(message.data)
            else:
                stamp = stamp_nanoseconds(message)
                if name == JOINT_STATES.name:
                    estimated_at.append(stamp)
                    estimated.extend(signals(message))
                elif stamp not in samples:
                    samples[stamp] = len(samples)
                    measured.extend(signals(message))
    if not samples:
        raise ParameterError(f"{bag}: no message on {MEASUREMENT.name}, nothing to compute from")
    stamps = np.fromiter(samples, np.int64)
    n = len(stamps)
    estimates = np.full((n + 1, SIGNALS), np.nan)
    places = [samples.get(stamp, n) for stamp in estimated_at]  # of no measurement: the last row
    estimates[places] = np.array(estimated).reshape(-1, SIGNALS)
    recorded = Recomputed(
        estimates[:n], _filled(floats[FRICTION_ESTIMATE.name], n), _filled(floats[COMMAND.name], n)
    )
    measurement = np.array(measured).reshape(-1, SIGNALS)
    return RecordedLoop((stamps - stamps[0]) / NANOSECONDS, measurement, recorded, changes)


def _filled(series: array[float], n: int) -> np.ndarray:
    """One value a sample; those that came after the last measurement go, missing ones are NaN."""
    filled = np.full(n, np.nan)
    filled[: min(n, len(series))] = series[:n]
    return filled


# Fields of a parameter's value by its type (rcl_interfaces/ParameterType).
_VALUES = {1: "bool_value", 2: "integer_value", 3: "double_value", 4: "string_value"}


def _value(value: Any) -> Any:
    if value.type == 0:
        return ()
    if value.type in _VALUES:
        return getattr(value, _VALUES[value.type])
    return tuple(float(each) for each in value.double_array_value)


def recomputed(
    bag: Path, files: tuple[Path, ...], assignments: tuple[str, ...]
) -> tuple[RecordedLoop, Recomputed]:
    """Compute a session again, with the recorded parameters unless others are given."""
    session = read_recorded_loop(bag)
    kept = bag / PARAMETERS_FILE
    base = read_file(kept) if kept.is_file() else load_settings([], [])
    # Recorded parameters of a later version may lack what this one has; defaults fill in.
    own = load_settings(files, assignments)
    parameters = [(0, loop(merge_settings(base, own)))]
    for sample, node, given in session.changes:
        if node in base:
            current = with_current_parameter_names(node, given)
            base = merge_settings(base, _only(base, node, current))
            parameters.append((sample, loop(merge_settings(base, own))))
    return session, recompute(session.measurement, parameters)


def _only(settings: Settings, node: str, given: dict[str, Any]) -> Settings:
    return {each: (given if each == node else {}) for each in settings}


def compare(session: RecordedLoop, again: Recomputed) -> dict[str, Any]:
    """Largest and mean square difference of each series where something was recorded."""
    result: dict[str, Any] = {"samples": len(session.time), "identical": True}
    for name in Recomputed._fields:
        old, new = getattr(session.recorded, name), getattr(again, name)
        here = np.isfinite(old)
        difference = (new - old)[here]
        same = bool(np.array_equal(new[here], old[here]))
        result["identical"] &= same
        result[name] = {
            "identical": same,
            "compared": int(np.sum(here)),
            "largest_difference": float(np.max(np.abs(difference), initial=0.0)),
            "rms_difference": float(np.sqrt(np.mean(difference**2))) if len(difference) else 0.0,
        }
    return result
