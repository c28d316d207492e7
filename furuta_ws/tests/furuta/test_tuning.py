"""Tuning sees the friction, finds a smaller swing, is safe, keeps its time, and follows the rig."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from furuta.outcomes import outcome
from furuta.settings.settings import load_settings, loop
from furuta.studies.trials import Compensation, TuningResult, observed_friction
from furuta.studies.tuning import (
    GuardError,
    ProgressCallback,
    SimulatedLoop,
    tune,
    tune_simulated,
)
from furuta.studies.tuning_plan import LEAST_SECONDS, TuningPlan
from furuta_model.friction.parameters import Friction
from furuta_sim.simulation.closed_loop import Loop, simulate

ENCODER_COUNT = 2.0 * np.pi / 250
TWISTING = "compensation=lugre", "super_twisting=10", "super_twisting_bandwidth=80"
RECOMMENDED = "compensation=recommended"
LATE = "drive.delay=10", "drive.lag=0.015"
NO_FRICTION = "plant.friction.alpha0=0", "plant.friction.alpha1=0"


def level(factor: float) -> tuple[str, ...]:
    """Coulomb friction, relative to the level that the observer knows."""
    return "friction.law=coulomb", f"plant.friction.alpha0={0.21 * factor}"


def loop_with(*assignments: str) -> Loop:
    """A loop with these settings."""
    return loop(load_settings([], assignments))


def silent(message: str, seconds: float) -> None:
    """Ignore progress."""


def tuned(
    rig: SimulatedLoop,
    true: Loop,
    follow: float = 0.0,
    report: ProgressCallback = silent,
) -> TuningResult:
    """Tune a rig."""
    start = Compensation(true.observer, true.controller)
    return tune(rig, start, true.estimator, TuningPlan(), report, follow)


def swing(true: Loop, result: TuningResult) -> float:
    """The true swing with the result [rad]; infinite after a fall."""
    run = outcome(true._replace(**result.after.compensation._asdict()), 60.0)
    return np.inf if run.fell else run.phi_peak_to_peak_rad


@pytest.mark.parametrize(("alpha0", "asymmetry"), [(0.26, 0.12), (0.1, 0.0), (0.3, -0.2)])
def test_the_friction_is_observed(alpha0: float, asymmetry: float) -> None:
    """Level to 2 %, asymmetry to 0.02; α₁ changes with α₀."""
    given = f"plant.friction.alpha0={alpha0}", f"plant.friction.asymmetry={asymmetry}"
    run = simulate(loop_with(*given, "friction.law=coulomb", "plant.seed=31"), 12.0)
    found = observed_friction(run.estimate[4000:], Friction(alpha0=0.2, alpha1=0.05))
    assert found.alpha0 == pytest.approx(alpha0, rel=0.02)
    assert found.asymmetry == pytest.approx(asymmetry, abs=0.02)
    assert found.alpha1 / found.alpha0 == pytest.approx(0.25)


def test_no_friction_is_observed_where_none_shows() -> None:
    """At rest, with one direction, without an observation, and where it drives the arm."""
    estimates, known = np.zeros((12_000, 5)), Friction()
    assert observed_friction(estimates, known) == known
    estimates[:, 1], estimates[:, 4] = 1.0, 0.3
    assert observed_friction(estimates, known) == known
    estimates[::2, 1] = -1.0
    for observed in (np.full(12_000, np.nan), -0.3 * estimates[:, 1]):
        estimates[:, 4] = observed
        assert observed_friction(estimates, known) == known
    estimates[:, 4] = 0.3 * estimates[:, 1]
    assert observed_friction(estimates, known).alpha0 == pytest.approx(0.3)


class DangerousRig(SimulatedLoop):
    """A rig that runs away with some strengths and records what is applied."""

    def __init__(self, true: Loop, dangerous: Callable[[float], bool], angle: int) -> None:
        super().__init__(true)
        self.applied = [Compensation(true.observer, true.controller)]
        self._dangerous, self._angle = dangerous, angle

    def apply(self, compensation: Compensation) -> None:
        """Record and apply."""
        self.applied.append(compensation)
        super().apply(compensation)

    def watch(self, seconds: float) -> np.ndarray:
        """The rig's estimates, or those of an arm or pendulum that runs away."""
        estimates = super().watch(seconds)
        if self._dangerous(self.applied[-1].controller.balance.strength):
            estimates[:, self._angle] = np.linspace(0.0, 5.0, len(estimates))
        return estimates


def test_a_trial_outside_the_guard_is_left_at_once() -> None:
    """The best setting so far is applied, and the search goes on."""
    true = loop_with(*TWISTING, *LATE, *level(0.3))
    rig = DangerousRig(true, lambda strength: 0.2 < strength < 0.6, 0)
    result = tuned(rig, true)
    left = [trial for trial in result.trials if trial.swing == np.inf]
    assert left
    for trial in left:
        assert rig.applied[rig.applied.index(trial.compensation) + 1] != trial.compensation
        assert result.trials.index(trial) < len(result.trials) - 1
    assert rig.applied[-1] == result.after.compensation
    assert result.after.swing < 0.5 * result.before.swing


@pytest.mark.parametrize(
    ("dangerous", "angle", "reason"),
    [
        (lambda strength: True, 0, "every trial left the guard of 1 rad"),
        (lambda strength: True, 2, "every trial left the guard of 1 rad"),
    ],
)
def test_a_motion_outside_the_guard_is_not_tuned(dangerous: Any, angle: int, reason: str) -> None:
    true = loop_with(*TWISTING)
    rig = DangerousRig(true, dangerous, angle)
    with pytest.raises(GuardError, match=reason):
        tuned(rig, true)
    assert rig.applied[-1] == rig.applied[0]


def test_initial_parameters_are_restored_after_a_fall() -> None:
    """A pendulum that has fallen does not come back with the best setting."""
    true = loop_with(*TWISTING, *LATE, *level(0.3))
    rig = DangerousRig(true, lambda strength: len(rig.applied) > 2, 2)
    with pytest.raises(GuardError, match="the pendulum left the guard of 1 rad"):
        tuned(rig, true)
    assert rig.applied[-1] == rig.applied[0]


@pytest.mark.parametrize("end", [30.0, 90.0])
def test_initial_parameters_are_restored_after_an_interruption(end: float) -> None:
    """Also while the swing is followed."""
    true = loop_with(*LATE, *level(0.1))
    rig = DangerousRig(true, lambda strength: False, 0)

    def interrupt(message: str, seconds: float) -> None:
        if seconds > end:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tuned(rig, true, 60.0, interrupt)
    assert rig.applied[-1] == rig.applied[0] != rig.applied[-2]


def test_no_gain_is_an_answer() -> None:
    """Without friction nothing is better than none; on a late drive little is enough."""
    as_it_was = tune_simulated(loop_with(*NO_FRICTION), TuningPlan(), silent)
    assert not as_it_was.gain
    assert as_it_was.parameters == {"friction_observer": {}, "controller": {}}
    found = tune_simulated(loop_with(*TWISTING, *LATE, *NO_FRICTION), TuningPlan(), silent)
    assert found.parameters["controller"]["strength"] < 0.2
    assert found.after.swing < 0.2 * found.before.swing


@pytest.mark.parametrize("start", [TWISTING, ()])
def test_what_a_late_drive_needs_is_found(start: tuple[str, ...]) -> None:
    """From 180 mrad with the recommended setting, and from 50 mrad with none, to half a count."""
    true = loop_with(*start, *LATE, *level(0.1))
    result = tune_simulated(true, TuningPlan(), silent)
    assert result.gain
    assert result.before.swing > (0.15 if start else 0.04)
    assert swing(true, result) < 0.5 * ENCODER_COUNT


def test_an_elastic_arm_does_not_fall() -> None:
    """With little or no compensation the pendulum would fall on this belt."""
    true = loop_with("coupling.frequency=22", *level(1.0), RECOMMENDED)
    result = tune_simulated(true, TuningPlan(), silent)
    assert all(trial.swing < 1.0 for trial in result.trials)
    assert swing(true, result) < 1.5 * ENCODER_COUNT


@pytest.mark.parametrize("seconds", [LEAST_SECONDS, 80.0, 120.0])
@pytest.mark.parametrize("friction", [0.0, 0.3, 1.0, 2.0])
def test_time_is_kept(seconds: float, friction: float) -> None:
    for given in (TWISTING, (), (*TWISTING, "drive.lag=0.03")):
        true = loop_with(*LATE, *level(friction), *given)
        result = tune_simulated(true, TuningPlan(seconds), silent)
        assert 16.0 <= result.seconds <= seconds


class ChangingRig(SimulatedLoop):
    """A rig whose friction is multiplied by factors at times [s]; it records the arm's swing."""

    def __init__(self, true: Loop, factors: dict[float, float]) -> None:
        super().__init__(true)
        self._factors = factors
        self.angles: list[np.ndarray] = []

    def watch(self, seconds: float) -> np.ndarray:
        """The rig's estimates."""
        plant = self._simulation.loop.plant
        known = plant.friction.parameters
        factor = self._factors.pop(round(0.001 * sum(map(len, self.angles)), 3), 1.0)
        friction = plant.friction._replace(parameters=known._replace(alpha0=factor * known.alpha0))
        changed = plant._replace(friction=friction)
        self._simulation.loop = self._simulation.loop._replace(plant=changed)
        estimates = super().watch(seconds)
        self.angles.append(estimates[:, 0])
        return estimates

    def swing(self, start: float, end: float) -> float:
        """Peak to peak [rad] between two times [s]."""
        angles = np.concatenate(self.angles)
        return float(np.ptp(angles[round(1000 * start) : round(1000 * end)]))


def test_the_swing_is_followed() -> None:
    """Friction grows by ten on a late drive, later it falls again: the swing follows in 60 s."""
    true = loop_with(*TWISTING, *LATE, *level(0.1))
    swings = []
    for follow in (230.0, 0.0):
        rig = ChangingRig(true, {140.0: 10.0, 260.0: 0.1})
        for _ in range(round(10.0 * (350.0 - tuned(rig, true, follow).seconds))):
            rig.watch(0.1)
        swings.append([rig.swing(start, start + 20.0) for start in (120.0, 200.0, 320.0)])
    followed, left = swings
    assert left[1] > 3.0 * left[0]
    assert followed[1] < 0.5 * left[1]
    assert followed[2] < 1.5 * followed[0]


def test_friction_that_appears_is_followed() -> None:
    """None was best before."""
    true = loop_with(*LATE, *level(1e-4))
    rig = ChangingRig(true, {60.0: 1e3})
    result = tuned(rig, true, 100.0)
    assert rig.swing(40.0, 60.0) < 0.2 * ENCODER_COUNT
    assert rig.swing(60.0, 70.0) > ENCODER_COUNT
    assert rig.swing(120.0, 130.0) < ENCODER_COUNT
    assert 0.02 < result.after.scale < 0.5
