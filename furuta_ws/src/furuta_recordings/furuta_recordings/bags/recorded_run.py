"""Reads a lock-step recording of the simulated graph, one row per sample."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from furuta_model.state import RIGID_STATES
from furuta_recordings.bags.bag import Bag, last_part, signals
from furuta_ros.time_stamps import NANOSECONDS, stamp_nanoseconds
from furuta_ros.topic_names import COMMAND, FRICTION_ESTIMATE, GROUND_TRUTH


class RecordedRun(NamedTuple):
    """Ground truth, friction estimate and command of a lock-step run.

    ``time`` (n,) [s], true ``state`` (n, 4), true ``friction`` (n,) [V], ``friction_estimate``
    (n,) [V], ``command`` (n,) [V].
    """

    time: np.ndarray
    state: np.ndarray
    friction: np.ndarray
    friction_estimate: np.ndarray
    command: np.ndarray

    def between(self, start: float, end: float) -> RecordedRun:
        """The samples with start ≤ time < end."""
        chosen = (self.time >= start - 1e-9) & (self.time < end - 1e-9)
        return RecordedRun(*(series[chosen] for series in self))


def read_recorded_run(path: Path) -> RecordedRun:
    """Read a lock-step recording with ground truth."""
    truth: list[list[float]] = []
    floats: dict[str, list[float]] = {FRICTION_ESTIMATE: [], COMMAND: []}
    with Bag(path) as bag:
        connections = [c for c in bag.connections if last_part(c.topic) in {GROUND_TRUTH, *floats}]
        for connection, _, message in bag.messages_in_memory(connections):
            name = last_part(connection.topic)
            if name == GROUND_TRUTH:
                truth.append([stamp_nanoseconds(message) / NANOSECONDS, *signals(message)])
            else:
                floats[name].append(message.data)
    samples = min(len(truth), *map(len, floats.values()))
    table = np.array(truth[:samples])
    return RecordedRun(
        table[:, 0],
        table[:, 1 : 1 + RIGID_STATES],
        table[:, -1],
        np.array(floats[FRICTION_ESTIMATE][:samples]),
        np.array(floats[COMMAND][:samples]),
    )
