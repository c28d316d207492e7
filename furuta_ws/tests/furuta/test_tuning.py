"""The friction fit is accurate; tuning finds good parameters, is safe, and keeps its time."""

import numpy as np
import pytest

from furuta.studies.tuning.observed_friction import fit_friction
from furuta.studies.tuning.plan import RIVALS, TuningPlan
from furuta.studies.tuning.tuning import GuardError, SimulatedLoop, tune
from furuta_control.estimation import EstimatorParameters
from furuta_control.estimators.kalman import sample_kalman
from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop, Simulation

NOMINAL = Friction()
STEP = sample_kalman(EstimatorParameters().rig, EstimatorParameters().parts.kalman)
# The motor of Fig. 6 with other friction than the compensator's default.
OTHER = Friction(alpha0=0.26, alpha1=0.03, asymmetry=0.12)


def plant(friction: Friction, seed: int) -> PlantParameters:
    """A rig with this friction."""
    return PlantParameters(friction=PlantFriction(parameters=friction), seed=seed)


def scaled(factor: float, friction: Friction = NOMINAL) -> Friction:
    """All of LuGre's five parameters wrong by a factor."""
    five = ("sigma0", "sigma1", "alpha0", "alpha1", "stribeck_velocity")
    return friction._replace(**{name: factor * getattr(friction, name) for name in five})


def test_friction_is_identified_from_the_limit_cycle() -> None:
    """Twelve seconds without compensation determine the friction from a start 30 % off."""
    true = OTHER._replace(sigma0=150.0, sigma1=3.0, viscous=0.05)
    simulation = Simulation(Loop(plant(true, 31)))
    simulation.run(3.0)
    found = fit_friction(simulation.run(12.0).estimate, STEP, 1e-3, scaled(0.7))
    assert found.alpha0 == pytest.approx(true.alpha0, rel=0.01)
    assert found.asymmetry == pytest.approx(true.asymmetry, abs=0.01)
    assert found.viscous == pytest.approx(true.viscous, abs=0.005)
    assert found.sigma0 == pytest.approx(true.sigma0, rel=0.1)
    assert found.sigma1 == pytest.approx(true.sigma1, rel=0.3)
    assert found.alpha0 + found.alpha1 == pytest.approx(true.alpha0 + true.alpha1, rel=0.1)


def test_a_fit_needs_observed_friction() -> None:
    resting = np.zeros((12_000, 5))
    with pytest.raises(ParameterError, match="hardly moved"):
        fit_friction(resting, STEP, 1e-3, NOMINAL)
    resting[:, 4] = np.nan
    with pytest.raises(ParameterError, match="observes no friction"):
        fit_friction(resting, STEP, 1e-3, NOMINAL)


class DangerousRig:
    """A rig that runs away with a large sigma1 and records the parameters that were applied."""

    def __init__(self, dangerous: float) -> None:
        self.applied: list[ObserverParameters] = []
        self.dangerous = dangerous
        self._rig = SimulatedLoop(Loop(PlantParameters(seed=34)))

    def apply(self, observer: ObserverParameters) -> None:
        """Record and apply."""
        self.applied.append(observer)
        self._rig.apply(observer)

    def watch(self, seconds: float) -> np.ndarray:
        """The rig's estimates, or those of an arm that runs away."""
        estimates = self._rig.watch(seconds)
        latest = self.applied[-1]
        if latest.compensation == "lugre" and latest.friction.sigma1 > self.dangerous:
            estimates[:, 0] = np.linspace(0.0, 5.0, len(estimates))
        return estimates


def test_a_candidate_outside_the_guard_is_rejected() -> None:
    """The best candidate so far is applied, and the search continues."""
    rig = DangerousRig(dangerous=2.0)
    start = ObserverParameters("lugre")
    tuned = tune(rig, start, EstimatorParameters(), TuningPlan(), lambda *_: None)
    dropped = [trial for trial in tuned.trials if trial.observer.friction.sigma1 > 2.0]
    assert dropped
    assert {trial.amplitude for trial in dropped} == {TuningPlan().arm_guard}
    for trial in dropped:
        after = rig.applied[rig.applied.index(trial.observer) + 1]
        assert after.friction.sigma1 <= 2.0
    assert rig.applied[-1] == tuned.after.observer
    assert tuned.after.observer.friction.sigma1 <= 2.0


def test_initial_parameters_are_restored_if_nothing_helps() -> None:
    rig = DangerousRig(dangerous=0.0)
    start = ObserverParameters("coulomb")
    with pytest.raises(GuardError, match="peak to peak"):
        tune(rig, start, EstimatorParameters(), TuningPlan(), lambda *_: None)
    assert rig.applied[-1] == start


def test_initial_parameters_are_restored_after_an_interruption() -> None:
    rig = DangerousRig(dangerous=np.inf)
    start = ObserverParameters("none")

    def interrupt(message: str, seconds: float) -> None:
        if seconds > 30.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tune(rig, start, EstimatorParameters(), TuningPlan(), interrupt)
    assert rig.applied[-1] == start


def test_no_gain_is_an_answer() -> None:
    """Where there is no friction, every compensator is worse than none, and none is the result."""
    rig = SimulatedLoop(Loop(plant(Friction(alpha0=0.0, alpha1=0.0), 37)))
    plan = TuningPlan(seconds=240.0, rivals=True)
    start = ObserverParameters("lugre")
    tuned = tune(rig, start, EstimatorParameters(), plan, lambda *_: None)
    assert tuned.after == tuned.uncompensated
    assert not tuned.gain
    assert tuned.seconds <= 240.0
    tried = {trial.observer.compensation for trial in tuned.trials}
    assert tried == {"lugre", *RIVALS}
    assert min(trial.amplitude for trial in tuned.trials) > 10.0 * tuned.after.amplitude
