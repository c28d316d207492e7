"""Automatic tuning of the compensation on a pendulum in motion, simulated or real.

1. The limit cycle is measured with the initial parameters.
2. The pendulum swings without compensation, and the friction parameters are fitted to the friction
   that the estimator observes (:mod:`.observed_friction`).
3. A trust-region search varies σ₁, which this fit determines worst and the delay of the estimator
   changes, and minimises the limit cycle that remains with compensation.
4. Other compensations are tried with the fitted friction, if the plan says so.
5. The best candidates are measured once more with the time that is left, because the minimum of
   noisy trials is biased low. The initial parameters and no compensation are candidates too: if
   nothing is better, one of them is the result.

The criterion is the peak-to-peak value of the estimated arm angle, which a real rig provides too.

Safety: the excursion is checked against a guard every tenth of a second. A candidate that exceeds
it is replaced by the best one so far. If that does not help, or at an interruption, the initial
parameters are restored.
"""

from collections.abc import Callable
from math import log
from typing import Protocol

import numpy as np

from furuta.studies.tuning.observed_friction import fit_friction
from furuta.studies.tuning.plan import (
    FINALISTS,
    FRICTION_RECORDING_TIME,
    FRICTION_SETTLING_TIME,
    MEASURING_TIME,
    RECOVERY_TIME,
    RIVALS,
    SETTLING_TIME,
    Trial,
    TuningPlan,
    TuningResult,
    search_method,
)
from furuta_control.estimation import EstimatorParameters
from furuta_control.estimators.kalman import sample_kalman
from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError, declared
from furuta_model.state import PHI, THETA
from furuta_sim.simulation.closed_loop import Loop, Simulation

# Called with a message and the pendulum time [s].
ProgressCallback = Callable[[str, float], None]

# One step of the search multiplies σ₁ by a factor.
STEP_FACTOR = 1.5
# First and last radius of the trust region, in steps.
RADII = (0.6, 0.1)
# Least amplitude that the search distinguishes from 0 [rad].
SMALLEST_AMPLITUDE = 1e-12
_SIGMA1 = next(item.about for item in declared(ObserverParameters) if item.name == "sigma1")
# Time between two checks of the guard [s].
GUARD_INTERVAL = 0.1


class TunableLoop(Protocol):
    """A closed loop in operation, simulated or real."""

    def apply(self, observer: ObserverParameters) -> None:
        """Set the friction observer's parameters."""

    def watch(self, seconds: float) -> np.ndarray:
        """Let the pendulum move on, and return the estimates (n, 5) of that time."""


class SimulatedLoop:
    """A simulation as a :class:`TunableLoop`."""

    def __init__(self, loop: Loop) -> None:
        self._simulation = Simulation(loop)

    def apply(self, observer: ObserverParameters) -> None:
        """Set the friction observer's parameters between two samples."""
        self._simulation.loop = self._simulation.loop._replace(observer=observer)

    def watch(self, seconds: float) -> np.ndarray:
        """Continue the simulation, and return the estimates (n, 5)."""
        return self._simulation.run(seconds).estimate


class GuardError(ParameterError):
    """The motion left the guard."""


class GuardedLoop:
    """A loop whose excursion is checked every tenth of a second.

    ``arm_guard`` [rad] is the largest allowed peak-to-peak angle of the arm, ``pendulum_guard``
    [rad] the largest allowed angle of the pendulum; ``elapsed`` is the pendulum time so far [s].
    """

    def __init__(self, loop: TunableLoop, arm_guard: float, pendulum_guard: float) -> None:
        self._loop = loop
        self._arm_guard = arm_guard
        self._pendulum_guard = pendulum_guard
        self.elapsed = 0.0

    def apply(self, observer: ObserverParameters) -> None:
        """Set the friction observer's parameters."""
        self._loop.apply(observer)

    def watch(self, seconds: float) -> np.ndarray:
        """The estimates (n, 5) of the next ``seconds``; :class:`GuardError` outside the guard."""
        low, high = np.inf, -np.inf
        parts = []
        for _ in range(int(seconds / GUARD_INTERVAL + 1e-6)):
            part = self.watch_unguarded(GUARD_INTERVAL)
            parts.append(part)
            low, high = min(low, part[:, PHI].min()), max(high, part[:, PHI].max())
            self._check(high - low, np.abs(part[:, THETA]).max())
        return np.concatenate(parts)

    def watch_unguarded(self, seconds: float) -> np.ndarray:
        """The estimates (n, 5) of the next ``seconds``, without a check."""
        self.elapsed += seconds
        return self._loop.watch(seconds)

    def _check(self, arm: float, pendulum: float) -> None:
        if arm > self._arm_guard or pendulum > self._pendulum_guard:
            raise GuardError(
                f"stopped and restored the initial parameters: arm {arm:.2f} rad peak to peak, "
                f"pendulum {pendulum:.2f} rad; the guard is {self._arm_guard:g} and "
                f"{self._pendulum_guard:g} rad (arm-guard, pendulum-guard)"
            )


def tune(
    rig: TunableLoop,
    start: ObserverParameters,
    estimator: EstimatorParameters,
    plan: TuningPlan,
    report: ProgressCallback,
) -> TuningResult:
    """Tune the LuGre compensator of ``rig`` and leave it with the best parameters found.

    Raises :class:`GuardError` if the motion leaves the guard with the initial parameters or without
    compensation, and :class:`ParameterError` if no friction is observed although the initial
    parameters are better than none. The initial parameters are then restored, as after any
    interruption.
    """
    plan.check()
    if not estimator.chosen.observes_friction:
        raise ParameterError(
            f"the estimator must observe the friction, as method kalman does; method "
            f"{estimator.method} does not"
        )
    try:
        result = _Tuner(rig, start, plan, report).run(estimator)
        rig.apply(result.after.observer)
        return result
    except BaseException:
        rig.apply(start)
        raise


def tune_simulated(loop: Loop, plan: TuningPlan, report: ProgressCallback) -> TuningResult:
    """Tune a simulated loop. ParameterError if it cannot be tuned."""
    return tune(SimulatedLoop(loop), loop.observer, loop.estimator, plan, report)


class _Tuner:
    def __init__(
        self,
        rig: TunableLoop,
        given: ObserverParameters,
        plan: TuningPlan,
        report: ProgressCallback,
    ) -> None:
        self._rig = GuardedLoop(rig, plan.arm_guard, plan.pendulum_guard)
        self._given = given
        self._start = given._replace(compensation="lugre")
        self._plan = plan
        self._report_progress = report
        self._trials: list[Trial] = []

    def run(self, estimator: EstimatorParameters) -> TuningResult:
        before = self._measure(self._start, MEASURING_TIME)
        self._report(f"before: {before.amplitude:.4f} rad")
        uncompensated, estimates = self._without_compensation()
        unchanged = [before, uncompensated]
        given = self._given_trial(unchanged)
        try:
            fitted = self._fit(estimates, estimator)
        except ParameterError as error:
            if before.amplitude < uncompensated.amplitude:
                raise
            self._report(f"nothing to tune: {error}")
        else:
            self._search(self._start._replace(friction=fitted))
        after = self._confirm_best([*unchanged, given])
        return TuningResult(before, uncompensated, given, after, self._trials, self._rig.elapsed)

    def _given_trial(self, unchanged: list[Trial]) -> Trial:
        """The motion with the initial compensation, measured only if it is not known yet."""
        for trial in unchanged:
            if trial.observer == self._given:
                return trial
        trial = self._measure(self._given, MEASURING_TIME)
        self._report(f"{self._given.compensation}, initial: {trial.amplitude:.4f} rad")
        return trial

    def _search(self, start: ObserverParameters) -> None:
        """Try LuGre compensation with other σ₁ than ``start`` has, then the rivals."""

        def cost(steps: np.ndarray) -> float:
            sigma1 = float(min(start.friction.sigma1 * STEP_FACTOR ** steps[0], _SIGMA1.high))
            tried = start._replace(friction=start.friction._replace(sigma1=sigma1))
            return log(max(self._try(tried), SMALLEST_AMPLITUDE))

        _search(cost, self._plan.max_trials)
        if self._plan.rivals and not self._plan.tries_rivals:
            self._report("no time left to try the other compensations")
        for rival in RIVALS if self._plan.tries_rivals else ():
            self._try(start._replace(compensation=rival))

    def _without_compensation(self) -> tuple[Trial, np.ndarray]:
        """The motion without compensation, and its estimates (n, 5)."""
        self._report("recording the friction without compensation")
        observer = self._start._replace(compensation="none")
        self._rig.apply(observer)
        self._rig.watch(FRICTION_SETTLING_TIME)
        estimates = self._rig.watch(FRICTION_RECORDING_TIME)
        trial = Trial(observer, float(np.ptp(estimates[:, PHI])))
        self._report(f"without compensation: {trial.amplitude:.4f} rad")
        return trial, estimates

    def _fit(self, estimates: np.ndarray, estimator: EstimatorParameters) -> Friction:
        """The friction parameters, from the limit cycle without compensation."""
        return fit_friction(
            estimates,
            sample_kalman(estimator.rig, estimator.parts.kalman),
            estimator.sample_time,
            self._start.friction,
        )

    def _try(self, observer: ObserverParameters) -> float:
        """The amplitude [rad] with a candidate, ``arm_guard`` if the motion leaves the guard."""
        try:
            trial = self._measure(observer, MEASURING_TIME)
        except GuardError:
            trial = Trial(observer, self._plan.arm_guard)
            self._retreat()
        self._trials.append(trial)
        name, sigma1 = observer.compensation, observer.friction.sigma1
        self._report(f"{name}, sigma1 {sigma1:.4g}: {trial.amplitude:.4f} rad")
        return trial.amplitude

    def _retreat(self) -> None:
        """Go back to the best candidate so far; if that leaves the guard too, tuning ends."""
        self._report("left the guard")
        best = min(self._trials, key=lambda trial: trial.amplitude, default=None)
        self._rig.apply(best.observer if best else self._start)
        # The excursion takes a while to decay; the guard holds again after that.
        self._rig.watch_unguarded(RECOVERY_TIME)
        self._rig.watch(GUARD_INTERVAL)

    def _confirm_best(self, unchanged: list[Trial]) -> Trial:
        """The best of the best candidates after a second measurement in the time that is left.

        One of ``unchanged``, the motions without tuning, if that is not worse.
        """
        best = sorted(self._trials, key=lambda trial: trial.amplitude)[:FINALISTS]
        seconds = (self._plan.seconds - self._rig.elapsed) / max(1, len(best)) - SETTLING_TIME
        confirmed = list(unchanged)
        for number, first in enumerate(best, start=1):
            self._report(f"second measurement of candidate {number} of {len(best)}")
            try:
                second = self._measure(first.observer, seconds)
            except GuardError:
                self._retreat()
                continue
            confirmed.append(second._replace(amplitude=max(first.amplitude, second.amplitude)))
        return min(confirmed, key=lambda trial: trial.amplitude)

    def _measure(self, observer: ObserverParameters, seconds: float) -> Trial:
        self._rig.apply(observer)
        self._rig.watch(SETTLING_TIME)
        return Trial(observer, float(np.ptp(self._rig.watch(seconds)[:, PHI])))

    def _report(self, message: str) -> None:
        self._report_progress(message, self._rig.elapsed)


def _search(cost: Callable[[np.ndarray], float], evaluations: int) -> None:
    """Call ``cost`` at most so often, near its minimum in the end."""
    from scipy.optimize import minimize

    (first, last), method = RADII, search_method()
    options = {"maxfev": evaluations, "initial_tr_radius": first, "final_tr_radius": last}
    if method == "COBYLA":
        options = {"maxiter": evaluations, "rhobeg": first, "tol": last}
    minimize(cost, np.zeros(1), method=method, options=options)
