"""Mode ``swing_up``: limits of the arm, energy, hand-overs and giving up."""

from math import pi

import numpy as np
import pytest
import reference

from furuta_control.control import (
    ACTIVE_MODES,
    ControllerMemory,
    ControllerParameters,
    active_mode,
    control,
    design_controller,
    reset,
)
from furuta_control.modes.swing_up import SwingUpParameters
from furuta_model.block import new_memory
from furuta_model.pendulum import FurutaPendulum

MODEL = FurutaPendulum()
PARAMETERS = ControllerParameters(mode="swing_up")
DT = 0.001


class Rig:
    """The frictionless rig with its controller, by the reference equations of motion."""

    def __init__(self, x: list[float], p: ControllerParameters = PARAMETERS) -> None:
        self.x, self._design = np.array(x), design_controller(p)
        self.memory = new_memory(ControllerMemory)[0]
        self.largest = np.zeros(3)
        self.modes: list[str] = []

    def run(self, seconds: float) -> None:
        """Run the loop."""
        for _ in range(round(seconds / DT)):
            seen = self.x.copy()
            seen[2] = (seen[2] + pi) % (2.0 * pi) - pi
            u = control(self.memory, seen, 0.0, self._design)
            mode = ACTIVE_MODES[active_mode(self.memory, self._design)]
            if not self.modes or self.modes[-1] != mode:
                self.modes.append(mode)
            self.x = reference_step(self.x, u)
            self.largest = np.maximum(self.largest, np.abs([*self.x[:2], u]))

    @property
    def upright(self) -> bool:
        """Whether the pendulum is upright now."""
        return bool(np.cos(self.x[2]) > 0.99)


def reference_step(x: np.ndarray, u: float) -> np.ndarray:
    """One sample of the rig by the classical Runge-Kutta method."""

    def rate(y: np.ndarray) -> np.ndarray:
        v_dot, w_dot = reference.accelerations(y[1], y[2], y[3], u, MODEL)
        return np.array((y[1], v_dot, y[3], w_dot))

    k1 = rate(x)
    k2 = rate(x + 0.5 * DT * k1)
    k3 = rate(x + 0.5 * DT * k2)
    k4 = rate(x + DT * k3)
    return np.asarray(x + DT / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4))


@pytest.mark.parametrize("theta", [-pi, 2.0, -1.0])
def test_swings_up_and_balances_within_the_limits(theta: float) -> None:
    """From rest at any angle: upright within 6 s, in the order of the phases, limits kept."""
    rig = Rig([0.5, 0.0, theta, 0.0])
    rig.run(6.0)
    assert rig.upright
    assert rig.modes[:2] == ["brake", "swing_up"]
    assert rig.modes[-2:] == ["catch", "balance"]
    limits = (
        PARAMETERS.balance.arm_angle_limit,
        PARAMETERS.balance.arm_speed_limit,
        PARAMETERS.voltage_limit,
    )
    assert np.all(rig.largest <= limits)


def fallen(recover: bool) -> Rig:
    """A rig that has been pushed over while it balanced."""
    rig = Rig([0.0, 0.0, 0.05, 0.0], PARAMETERS._replace(swing_up=SwingUpParameters(recover)))
    rig.run(1.0)
    assert rig.modes[-1] == "balance"
    rig.x[3] = 6.0
    rig.run(8.0)
    return rig


def test_recovers_only_if_it_may() -> None:
    """After a fall the pendulum is swung up again with ``recover``, and let hang without."""
    assert fallen(True).upright
    rig = fallen(False)
    assert rig.modes[-1] == "off"
    assert not rig.upright
    reset(rig.memory)
    rig.run(6.0)
    assert rig.upright


def test_an_arm_beyond_its_travel_ends_the_swing_up() -> None:
    """It is braked and left at 0 V, also with ``recover``."""
    rig = Rig([6.5, 0.0, -pi, 0.0], PARAMETERS._replace(swing_up=SwingUpParameters(recover=True)))
    rig.run(1.0)
    assert rig.memory["swing_up"]["beyond"]
    assert not rig.memory["swing_up"]["caught"]
    assert rig.modes[-1] == "off"


def test_unknown_state_is_not_driven() -> None:
    """NaN in any state gives 0 V in every phase."""
    for index in range(4):
        rig = Rig([0.0, 0.0, 3.0, 0.0])
        rig.run(0.1)
        x = rig.x.copy()
        x[index] = np.nan
        assert control(rig.memory, x, 0.3, design_controller(PARAMETERS)) == 0.0
