"""Swing-up: which rigs and estimators are refused, travel in turns, and what counts as a fall."""

from math import pi

import numpy as np
import pytest

from furuta.settings.settings import load_settings, loop
from furuta.studies.swing_up import Knocks, count_knocks, swing_up_settings
from furuta_hw.rigs.known_rigs import find_rig
from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Record


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


def test_knocks_are_counted() -> None:
    """Down for a second at 20 s, and from 50 s on: two falls, one swing-up, 49 s upright."""
    state = np.zeros((30_000, 4))
    state[10_000:10_500, 2] = state[25_000:, 2] = pi
    empty = np.empty(0)
    run = Record(0.002, state, empty, empty, empty, empty, empty)
    assert count_knocks(run) == Knocks(5, 2, 1, pytest.approx(49.0))
