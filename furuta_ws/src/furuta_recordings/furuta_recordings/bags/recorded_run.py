"""What a recorded lock-step run was in truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from furuta_model.state import RIGID_STATES
from furuta_recordings.bags.bag import Bag, last_part, signals
from furuta_ros.messages import NANOSECONDS, stamp_nanoseconds
from furuta_ros.topics import COMMAND, FRICTION_ESTIMATE, GROUND_TRUTH


class RecordedRun(NamedTuple):
    """What a lock-step run of the graph was in truth, one row per sample.

    ``time`` (n,) [s], true ``state`` (n, 4), true ``friction`` (n,) [V], ``friction_estimate``
    (n,) [V], ``command`` (n,) [V].
    """

    time: np.ndarray
    state: np.ndarray
    friction: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray

    def between(self, start: float, end: float) -> RecordedRun:
        """The part with start ≤ time < end."""
        chosen = (self.time >= start - 1e-9) & (self.time < end - 1e-9)
        return RecordedRun(*(series[chosen] for series in self))


def read_recorded_run(path: Path) -> RecordedRun:
    """Read a lock-step recording with ground truth."""
    rows: list[list[float]] = []
    floats: dict[str, list[float]] = {FRICTION_ESTIMATE.name: [], COMMAND.name: []}
    with Bag(path) as reader:
        wanted = {GROUND_TRUTH.name, *floats}
        connections = [c for c in reader.connections if last_part(c.topic) in wanted]
        for connection, _, data in reader.messages(connections):
            message: Any = reader.deserialize(data, connection.msgtype)
            name = last_part(connection.topic)
            if name == GROUND_TRUTH.name:
                rows.append([stamp_nanoseconds(message) / NANOSECONDS, *signals(message)])
            else:
                floats[name].append(message.data)
    samples = min(len(rows), *map(len, floats.values()))
    table = np.array(rows[:samples])
    return RecordedRun(
        table[:, 0],
        table[:, 1 : 1 + RIGID_STATES],
        table[:, -1],
        np.array(floats[FRICTION_ESTIMATE.name][:samples]),
        np.array(floats[COMMAND.name][:samples]),
    )
