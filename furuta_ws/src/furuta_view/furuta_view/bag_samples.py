"""Reads the samples of a recording around a time, without reading the rest of it."""

import logging
from contextlib import ExitStack
from functools import lru_cache
from math import floor, nan, pi, remainder
from pathlib import Path
from typing import Any

import numpy as np

from furuta_graph.settings.nodes import NODES
from furuta_graph.settings.settings import parameters_of, read_file
from furuta_model.parameters import ParameterError, build, values
from furuta_recordings.bags.bag import Bag, last_part, parameter_file_of
from furuta_recordings.bags.series import joint_numbers
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topic_names import COMMAND as COMMAND_TOPIC
from furuta_ros.topic_names import (
    FRICTION_ESTIMATE,
    GROUND_TRUTH,
    JOINT_STATES,
    JOINTS,
    MEASUREMENT,
)
from furuta_view.samples import COLUMNS, COMMAND, ESTIMATE, FRICTION, PHI, THETA, TIME

_LOG = logging.getLogger(__name__)

# Topics with the state, the best one first.
STATES = (GROUND_TRUTH, JOINT_STATES, MEASUREMENT)
# Length of the blocks in which a recording is read [s], and how many are kept.
BLOCK = 1.0
KEPT_BLOCKS = 64
# Most samples of a block; the others are not read.
MOST = 100


class BagSamples:
    """A recording, to be closed; ``seconds`` is its length."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with ExitStack() as opened:
            self._bag = opened.enter_context(Bag(path))
            topics = {last_part(topic.topic): topic for topic in self._bag.connections}
            best = next((name for name in STATES if name in topics), None)
            if best is None:
                raise ParameterError(f"{path} has none of the topics {', '.join(STATES)}")
            self._state = topics[best]
            self._has_truth = best == GROUND_TRUTH
            floats = ((ESTIMATE, FRICTION_ESTIMATE), (COMMAND, COMMAND_TOPIC))
            self._floats = [(topics[name], column) for column, name in floats if name in topics]
            self._opened = opened.pop_all()
        self.seconds = self._bag.seconds
        self._block = lru_cache(KEPT_BLOCKS)(self._read_block)

    def close(self) -> None:
        """Close its files."""
        self._opened.close()

    def parameters(self) -> dict[str, dict[str, Any]]:
        """The recorded parameters of all nodes, or the defaults if there are none."""
        file = parameter_file_of(self.path)
        if file is None:
            return {}
        recorded = read_file(file)
        try:
            return {node: values(group) for node, group in parameters_of(recorded).items()}
        except ParameterError as error:  # such as a part of the user's own
            _LOG.warning("no exact cycle: %s", error)
            defaults = {name: values(build(node.parameters, {})) for name, node in NODES.items()}
            return {node: defaults[node] | recorded[node] for node in NODES}

    def window(self, end: float, seconds: float) -> np.ndarray:
        """The samples (n, 8) of the ``seconds`` before ``end``; times count from the start."""
        first, last = max(0, floor((end - seconds) / BLOCK)), max(0, floor(end / BLOCK))
        samples = np.vstack([self._block(number) for number in range(first, last + 1)])
        times = samples[:, TIME]
        return samples[(times > end - seconds) & (times <= end)]

    def _read_block(self, number: int) -> np.ndarray:
        """The samples (n, 8) of a block."""
        start = self._bag.start
        first, last = (start + round(k * BLOCK * NANOSECONDS) for k in (number, number + 1))
        times, states = self._bag.find(self._state, first, last)
        chosen = np.arange(0, len(times), len(times) // MOST + 1)
        samples = np.full((len(chosen), COLUMNS), nan)
        for row, index in zip(samples, chosen.tolist(), strict=True):
            self._fill(row, states[index])
        samples[:, TIME] = (times[chosen] - start) / NANOSECONDS
        for topic, column in self._floats:
            samples[:, column] = _newest(*self._bag.find(topic, first, last), times[chosen])
        return samples

    def _fill(self, row: np.ndarray, data: bytes) -> None:
        message = self._bag.deserialize(data, self._state.msgtype)
        names = list(message.name)
        for joint, angle in zip(JOINTS, (PHI, THETA), strict=True):
            if joint in names:
                row[angle], row[angle + 1], effort = joint_numbers(message, names.index(joint))
                if self._has_truth and angle == PHI:
                    row[FRICTION] = effort
        row[THETA] = remainder(row[THETA], 2 * pi) if np.isfinite(row[THETA]) else nan


def _newest(received: np.ndarray, numbers: list[bytes], times: np.ndarray) -> np.ndarray:
    """At each of the times (n,) [ns] the newest number, or the first one; NaN if there is none."""
    if not numbers:
        return np.full(len(times), nan)
    rows = np.maximum(np.searchsorted(received, times, side="right") - 1, 0)
    return np.array([np.frombuffer(numbers[row], "<f8", 1, 4)[0] for row in rows])
