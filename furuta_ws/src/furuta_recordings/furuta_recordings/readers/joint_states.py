"""Numbers in JointState messages and commands of any rig."""

from math import nan
from pathlib import Path
from typing import Any, NamedTuple

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT
from furuta_ros.time_stamps import NANOSECONDS, stamp_nanoseconds


class JointSample(NamedTuple):
    """A message: time stamp [s], x = (φ, φ̇, θ, θ̇), the arm's effort; NaN where not given."""

    stamp: float
    state: tuple[float, ...]
    effort: float


def joint_sample(message: Any, arm: str, pendulum: str) -> JointSample:
    """State of the joints named ``arm`` and ``pendulum`` in a JointState message."""
    x, effort, names = [nan] * 4, nan, list(message.name)
    for joint, angle, speed in ((arm, PHI, PHI_DOT), (pendulum, THETA, THETA_DOT)):
        if joint in names:
            index = names.index(joint)
            x[angle] = _at(message.position, index)
            x[speed] = _at(message.velocity, index)
    if arm in names:
        effort = _at(message.effort, names.index(arm))
    return JointSample(stamp_nanoseconds(message) / NANOSECONDS, tuple(x), effort)


def _at(series: Any, index: int) -> float:
    return float(series[index]) if index < len(series) else nan


def command_value(path: Path, message: Any) -> float:
    """The command in a message: its data, or the first element of an array."""
    value = getattr(message, "data", None)
    if value is None:
        raise ParameterError(
            f"{path}: a command needs a number in `data`, the type {message.__msgtype__} has none"
        )
    if isinstance(value, (int, float)):
        return float(value)
    if not len(value):
        raise ParameterError(f"{path}: a command message has an empty array")
    return float(value[0])
