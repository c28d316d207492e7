"""Messages to arrays and back; nonsense is refused before it reaches a core."""

from __future__ import annotations

from array import array
from math import inf, nan

import numpy as np
import pytest
from std_msgs.msg import Float64
from testbench import joint_state

from furuta_ros.messages import RefusedError, read_float, read_joints, stamp_nanoseconds

STATE = (0.1, -0.2, 0.3, -0.4)


def read(message: object, speed: bool = True) -> np.ndarray:
    x = np.zeros(4)
    read_joints(message, x, speed)
    return x


def test_round_trip() -> None:
    """What is written is read, stamp included."""
    message = joint_state(STATE, 12_345_678_901)
    assert read(message).tolist() == list(STATE)
    assert stamp_nanoseconds(message) == 12_345_678_901


def test_joints_are_found_by_name() -> None:
    """The order of the joints in a message does not matter."""
    message = joint_state(STATE, 0, ["pendulum", "arm"])
    assert read(message).tolist() == [0.3, -0.4, 0.1, -0.2]


@pytest.mark.parametrize(
    "names", [["a", "b"], ["arm"], [], ["arm", "arm"], ["arm", "pendulum", "x"]]
)
def test_wrong_joint_names_are_refused(names: list[str]) -> None:
    """The reason says which names are needed and which came."""
    with pytest.raises(RefusedError, match=r"\['arm', 'pendulum'\]"):
        read(joint_state(STATE, 0, names))


@pytest.mark.parametrize("field", ["position", "velocity"])
@pytest.mark.parametrize(
    "values", [[], [0.0], [0.0, 0.0, 0.0], [nan, 0.0], [0.0, inf], [-inf, inf]]
)
def test_bad_values_are_refused_and_nothing_is_written(field: str, values: list[float]) -> None:
    """Empty, short, long and non-finite arrays leave the state as it was."""
    message = joint_state(STATE, 0)
    setattr(message, field, array("d", values))
    x = np.full(4, 7.0)
    with pytest.raises(RefusedError):
        read_joints(message, x)
    assert x.tolist() == [7.0] * 4


def test_unmeasured_pendulum_speed_may_be_nan() -> None:
    """A rig without a sensor for it says NaN, which only who needs it refuses."""
    message = joint_state((0.1, -0.2, 0.3, nan), 0)
    assert read(message, speed=False)[:3].tolist() == [0.1, -0.2, 0.3]
    with pytest.raises(RefusedError):
        read(message)


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_non_finite_number_is_refused(value: float) -> None:
    """A command or friction estimate is a finite number."""
    with pytest.raises(RefusedError, match="finite"):
        read_float(Float64(data=value))
