"""The emulated rig without its process."""

import pytest

from furuta_hw.emulator.emulated_rig import EmulatedRig
from furuta_hw.emulator.running_rig import RunningRig
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import ParameterError
from furuta_model.state import THETA


def test_the_pendulum_is_held_where_the_monitor_asks() -> None:
    """There, or in the initial state; a wrong name changes nothing."""
    rig = EmulatedRig(Rig())
    running = RunningRig(rig, 0.001)
    start = rig.x[THETA]
    assert running.answer({"do": "hold"})["state"][THETA] == start
    assert running.answer({"do": "hold", "theta": 3.13})["state"][THETA] == 3.13
    with pytest.raises(ParameterError, match="no state thta; states are phi"):
        running.answer({"do": "hold", "thta": 0.1})
    for _ in range(10):
        rig.step()
    assert rig.x[THETA] == 3.13
    assert rig.held
