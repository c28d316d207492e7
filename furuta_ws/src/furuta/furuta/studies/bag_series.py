"""The columns of a bag: measurements, estimates, command and, where recorded, the truth."""

from pathlib import Path

import numpy as np

from furuta.studies.recomputation import RecordedLoop, read_recorded_loop
from furuta_model.parameters import ParameterError
from furuta_model.state import SIGNALS
from furuta_recordings.bags.bag import Bag, last_part, signals
from furuta_recordings.readers import Mapping as Names
from furuta_recordings.readers import read
from furuta_recordings.readers.bag_topics import JOINT_STATE_TYPE
from furuta_recordings.recording import Recording
from furuta_recordings.series_columns import (
    COMMAND,
    ESTIMATED,
    FRICTION_ESTIMATE,
    MEASURED,
    TIME,
    TRUE,
    Series,
    by_name,
    known,
)
from furuta_ros import topic_names
from furuta_ros.time_stamps import stamp_nanoseconds
from furuta_ros.topic_names import GROUND_TRUTH, MEASUREMENT

FLOATS = (topic_names.FRICTION_ESTIMATE, topic_names.COMMAND)
# Types of the graph's topics; a bag with other types is of another rig.
TYPES = {
    MEASUREMENT: JOINT_STATE_TYPE,
    GROUND_TRUTH: JOINT_STATE_TYPE,
    **dict.fromkeys(FLOATS, "std_msgs/msg/Float64"),
}


def bag_series(path: Path, names: Names) -> Series:
    """The columns of a bag of the graph, or of another rig's if there are ``names``."""
    with Bag(path) as bag:
        types = [
            (last_part(connection.topic), connection.msgtype) for connection in bag.connections
        ]
        graphs = [
            connection.topic
            for connection in bag.connections
            if last_part(connection.topic) == MEASUREMENT
        ]
    usual = all(TYPES[name] == kind for name, kind in types if name in TYPES)
    if len(graphs) > 1:
        raise ParameterError(f"{path} holds several graphs: {', '.join(sorted(graphs))}")
    if not (graphs and usual) or names != Names():
        return recorded_series(read(path, names)[0])
    recorded = read_recorded_loop(path)
    others = _others(path, recorded)
    return known(
        {
            TIME: recorded.time,
            **by_name(MEASURED, recorded.measurement),
            **by_name(ESTIMATED, recorded.outputs.estimate),
            FRICTION_ESTIMATE: others[topic_names.FRICTION_ESTIMATE][:, 0],
            COMMAND: others[topic_names.COMMAND][:, 0],
            **by_name(TRUE, others[GROUND_TRUTH]),
        }
    )


def _others(path: Path, recorded: RecordedLoop) -> dict[str, np.ndarray]:
    """Truth (n, 5), friction estimate and command (n, 1) at each measurement; NaN where missing.

    The truth has time stamps. Friction estimates and commands have none: if there is one for each
    measurement they are taken in order, otherwise by the time at which they were recorded.
    """
    rows = {int(stamp): row for row, stamp in enumerate(recorded.stamps)}
    truth = np.full((len(rows), SIGNALS), np.nan)
    arrivals = np.zeros(len(rows), np.int64)
    floats: dict[str, list[tuple[int, float]]] = {name: [] for name in FLOATS}
    with Bag(path) as bag:
        topics = [
            connection for connection in bag.connections if last_part(connection.topic) in TYPES
        ]
        for connection, time, message in bag.messages_in_memory(topics):
            name = last_part(connection.topic)
            if name in floats:
                floats[name].append((time, message.data))
            elif (row := rows.get(stamp_nanoseconds(message))) is None:
                continue
            elif name == GROUND_TRUTH:
                truth[row] = signals(message)
            elif not arrivals[row]:  # a measurement may be repeated
                arrivals[row] = time
    aligned = {name: _aligned(values, arrivals) for name, values in floats.items()}
    return {GROUND_TRUTH: truth, **aligned}


def _aligned(messages: list[tuple[int, float]], arrivals: np.ndarray) -> np.ndarray:
    """Values (n, 1) of messages (time [ns], value) at measurements that arrived at ``arrivals``."""
    if len(messages) == len(arrivals):
        return np.array([[value] for _, value in messages])
    values = np.full((len(arrivals), 1), np.nan)
    for time, value in messages:
        row = int(np.searchsorted(arrivals, time, side="right")) - 1
        if row >= 0:
            values[row] = value
    return values


def recorded_series(recording: Recording) -> Series:
    """The columns of a recording of any rig; the command is the one that held at each sample."""
    missing = np.full((len(recording.time), 1), np.nan)
    measured = by_name(MEASURED, np.hstack([recording.measured, missing]))
    command = recording.commanded_at(recording.time)
    return known({TIME: recording.time, **measured, COMMAND: command})
