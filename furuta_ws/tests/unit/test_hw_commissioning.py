"""Commissioning against rigs in software whose truth is known."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from furuta_hw.commissioning import measure_friction, signs, zeros
from furuta_hw.emulated import EmulatedRig, simulated
from furuta_hw.errors import NotStillError
from furuta_hw.faults import Faults
from furuta_hw.frames import FrameReader, Sensors
from furuta_hw.rig import Arm, Pendulum, Rig, Speed
from furuta_hw.sensing import Sensing
from furuta_hw.session import Experiment
from furuta_model.friction.parameters import LuGre
from furuta_model.parameters import ParameterError
from furuta_sim.parameters import InitialState

HANGING = InitialState(theta=pi)


class Driven(EmulatedRig):
    """A rig whose drive is set from here, without a line."""

    def step(self, volts: float) -> Sensors:
        """One sample at this voltage."""
        self.held = False
        firmware = self.firmware
        firmware.session, firmware.watchdog, firmware.answered = 0, 2, firmware.number
        firmware.code, firmware._status = self._drive.to_code(volts), 1
        (sensors,) = FrameReader().feed(self.tick())
        assert isinstance(sensors, Sensors)
        return sensors


def perform(rig: Rig, experiment: Experiment, true: Rig | None = None) -> tuple:
    """Run an experiment with what ``rig`` says on a rig that is truly ``true``."""
    true = true or rig
    body = Driven(true, simulated(true, HANGING))
    sensing, furthest = Sensing(rig), 0.0
    volts = next(experiment)
    try:
        while True:
            x = sensing.take(body.step(volts))
            furthest = max(furthest, abs(x[0]))
            volts = experiment.send(x)
    except StopIteration as done:
        return done.value, furthest


@pytest.mark.parametrize(
    "friction",
    [LuGre(), LuGre(asymmetry=0.15, viscous=0.05), LuGre(alpha0=0.4, alpha1=0.1)],
    ids=["paper", "asymmetric", "strong"],
)
def test_friction_is_found(friction: LuGre) -> None:
    """Levels, asymmetry and viscous part, from one count of 25 mrad and a noisy tachometer."""
    rig = Rig(friction=friction)
    found, furthest = perform(rig, measure_friction(rig, 3.0))
    assert found.alpha0 == pytest.approx(friction.alpha0, rel=0.01)
    stiction = friction.alpha0 + friction.alpha1
    assert found.alpha0 + found.alpha1 == pytest.approx(stiction, rel=0.04)
    assert found.asymmetry == pytest.approx(friction.asymmetry, abs=0.01)
    assert found.viscous == pytest.approx(friction.viscous, abs=0.005)
    assert furthest < 3.0


def test_friction_needs_room() -> None:
    """A travel too short for a slide is refused before anything moves."""
    with pytest.raises(ParameterError, match="travel must be at least"):
        next(measure_friction(Rig(), 0.5))


@pytest.mark.parametrize("arm", [1, -1])
@pytest.mark.parametrize("speed", [1, -1])
def test_signs_are_found(arm: int, speed: int) -> None:
    """However encoder and tachometer are wired, the nudge tells, with the default rig file."""
    true = Rig(arm=Arm(sign=arm), speed=Speed(sign=speed))
    found, furthest = perform(Rig(), signs(Rig(), 1.0), true)
    assert (found.arm, found.speed, found.pendulum) == (arm, speed, None)
    assert furthest < 0.2


@pytest.mark.parametrize("sign", [1, -1])
def test_sign_of_a_hanging_pendulum(sign: int) -> None:
    """Seen by an encoder, it lags behind the arm."""
    given = Rig(pendulum=Pendulum(sensor="encoder", counts_per_turn=8192))
    true = given._replace(pendulum=given.pendulum._replace(sign=sign))
    assert perform(given, signs(given, 1.0), true)[0].pendulum == sign


def still(rig: Rig, theta: float, samples: int = 500) -> list[Sensors]:
    body = EmulatedRig(rig, simulated(rig, InitialState(phi=0.4, theta=theta)), Faults())
    body.firmware.session = 0
    reader = FrameReader()
    return [s for _ in range(samples) for s in reader.feed(body.tick()) if isinstance(s, Sensors)]


def test_zeros_are_found() -> None:
    """With the pendulum upright the codes at rest are the zeros; half a turn away if it hangs."""
    found = zeros(still(Rig(), 0.05), Rig(), hanging=False)
    assert found["arm.zero"] == 16
    assert found["pendulum.zero"] == pytest.approx(0.05 / (pi / 4 / 2048), abs=0.3)
    assert found["speed.zero"] == pytest.approx(0.0, abs=0.3)
    rig = Rig(pendulum=Pendulum(sensor="encoder", counts_per_turn=2000, zero=7.0))
    found = zeros(still(rig, pi - 1e-3), rig, hanging=True)
    assert found["pendulum.zero"] % 2000 == pytest.approx(7.0, abs=0.6)


def test_zeros_of_what_moves_are_refused() -> None:
    """Nor of what its sensor cannot see."""
    samples = still(Rig(), 0.0)
    moved = [s._replace(arm=s.arm + k // 10) for k, s in enumerate(samples)]
    with pytest.raises(NotStillError, match="arm moves"):
        zeros(moved, Rig(), hanging=False)
    with pytest.raises(NotStillError, match="end of its range"):
        zeros(still(Rig(), 2.0), Rig(), hanging=False)
    assert np.ptp([s.arm for s in samples]) == 0
