"""Settings of swing-up: which rigs and estimators are refused, and the arm's travel in turns."""

from __future__ import annotations

from math import pi
from pathlib import Path

import pytest

from furuta.studies.swing_up.rig_loop import swing_up_settings
from furuta_hw.rigs.rig_file import load_rig
from furuta_model.parameters import ParameterError
from furuta_sim.settings.rigs import find_rig
from furuta_sim.settings.settings import load_settings, loop


def test_needs_a_full_turn_sensor() -> None:
    """The paper's potentiometer cannot see the hanging pendulum: refused, with the range."""
    with pytest.raises(ParameterError, match=r"potentiometer_range must be .* 3\.14.*given 0\.785"):
        load_settings([], [], swing_up_settings(find_rig("paper")))
    ideal = load_settings([], ["sensors.ideal=true"], swing_up_settings(find_rig("paper")))
    assert loop(ideal).controller.mode == "swing_up"


def test_needs_an_estimator_of_the_circle() -> None:
    """The linear Kalman filter is for upright only."""
    settings = swing_up_settings(find_rig("qube_servo_2"))
    assert loop(load_settings([], [], settings)).estimator.method == "whole_circle"
    with pytest.raises(ParameterError, match="whole_circle; given kalman"):
        load_settings([], ["estimator.method=kalman"], settings)


def test_arm_travel_in_turns(tmp_path: Path) -> None:
    """It is the angle limit; both at once, and nonsense, are refused."""
    file = tmp_path / "rig.yaml"
    file.write_text("limits: {arm_turns: 0.75}")
    assert load_rig(file).limits.arm_angle == pytest.approx(1.5 * pi)
    for given in ("{arm_turns: 1, arm_angle: 1}", "{arm_turns: -1}", "{arm_turns: many}"):
        file.write_text(f"limits: {given}")
        with pytest.raises(ParameterError, match=r"limits\.arm_turns"):
            load_rig(file)
