"""Mode ``swing_up``: limits of the arm, energy, hand-overs and giving up."""

from math import pi
from typing import Any

import numpy as np
import pytest
import reference

from furuta_control.control import (
    ACTIVE_MODES,
    ControllerMemory,
    ControllerParameters,
    ModeParameters,
    active_mode,
    control,
    design_controller,
    reset,
)
from furuta_control.modes import arm_limits, energy_shaping
from furuta_control.modes.swing_up import SwingUpParameters
from furuta_model.block import new_memory
from furuta_model.pendulum import FurutaPendulum, arm_dynamics

RNG = np.random.default_rng(16)
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


def test_the_torque_gives_the_wanted_acceleration() -> None:
    """With u − F = inertia a + torque the reference equations accelerate the arm by a."""
    for v, theta, w, wanted in RNG.uniform(-5.0, 5.0, (20, 4)):
        inertia, torque = arm_dynamics(v, theta, w, MODEL)
        found, _ = reference.accelerations(v, theta, w, inertia * wanted + torque, MODEL)
        assert found == pytest.approx(wanted, abs=1e-9)


def test_limited_speed_can_stop_before_the_limit() -> None:
    """An arm that follows the limited acceleration never passes the used travel and speed."""
    p = arm_limits.design(MODEL, 10.0, 0.0, 2.0, 9.9, DT)
    phi = v = 0.0
    for _ in range(3000):
        v += DT * arm_limits.limited(1e3, phi, v, p)
        phi += DT * v
        assert phi < 1.02 * p.travel
        assert v < 1.02 * p.speed
    assert phi == pytest.approx(p.travel, rel=0.05)


def test_energy_shaping_drives_the_energy_to_its_target() -> None:
    """Below the target the acceleration adds energy, above it takes some: −cosθ θ̇ a against E."""
    limits = arm_limits.design(MODEL, 10.0, 0.0, 6.0, 9.9, DT)
    p = energy_shaping.design(MODEL, 10.0, limits)
    for theta, w in ((2.5, 1.0), (-2.5, 1.0), (2.5, -1.0), (0.3, 20.0), (0.3, -20.0)):
        memory = new_memory(energy_shaping.EnergyShapingMemory)[0]
        state = np.array((0.0, 0.0, theta, w))
        power = -np.cos(theta) * w * energy_shaping.acceleration(memory, state, p)
        energy = 0.25 * w * w / p.squared_frequency + 0.5 * (np.cos(theta) - 1.0)
        assert power * (energy_shaping.FIRST_TARGET - energy) > 0.0


@pytest.mark.parametrize("theta", [-pi, 2.0, -1.0])
def test_swings_up_and_balances_within_the_limits(theta: float) -> None:
    """From rest at any angle: upright within 6 s, in the order of the phases, limits kept."""
    rig = Rig([0.5, 0.0, theta, 0.0])
    rig.run(6.0)
    assert rig.upright
    assert rig.modes[:2] == ["brake", "swing_up"]
    assert rig.modes[-2:] == ["catch", "balance"]
    limits = (PARAMETERS.arm_angle_limit, PARAMETERS.arm_speed_limit, PARAMETERS.voltage_limit)
    assert np.all(rig.largest <= limits)


def recovering(recover: bool) -> Any:
    """The parameters of the mode."""
    return ModeParameters(swing_up=SwingUpParameters(recover))


def fallen(recover: bool) -> Rig:
    """A rig that has been pushed over while it balanced."""
    rig = Rig([0.0, 0.0, 0.05, 0.0], PARAMETERS._replace(parts=recovering(recover)))
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
    rig = Rig([6.5, 0.0, -pi, 0.0], PARAMETERS._replace(parts=recovering(True)))
    rig.run(1.0)
    assert rig.memory["parts"]["swing_up"]["beyond"]
    assert not rig.memory["parts"]["swing_up"]["caught"]
    assert rig.modes[-1] == "off"


def test_unknown_state_is_not_driven() -> None:
    """NaN in any state gives 0 V in every phase."""
    for index in range(4):
        rig = Rig([0.0, 0.0, 3.0, 0.0])
        rig.run(0.1)
        x = rig.x.copy()
        x[index] = np.nan
        assert control(rig.memory, x, 0.3, design_controller(PARAMETERS)) == 0.0
