"""Automatic tuning of the LuGre compensator on a pendulum in motion, simulated or real.

First the pendulum swings without compensation and the friction's parameters are read off what the
estimator sees (:mod:`.seen_friction`). Then the limit cycle that is left with compensation is made
as small as it gets by a trust-region search (COBYQA) on the few parameters that the data tell
least, and the best candidates are looked at again with the time that is left, since the least of
noisy figures is mostly luck. What counts is what a rig can measure: the peak-to-peak value of the
estimated arm angle.

Safety: between any two moments of a tenth of a second the excursion is checked against a guard.
A candidate that exceeds it is dropped for the best so far; where that does not help, or at an
interruption, the parameters that were there at the start are put back.
"""

from __future__ import annotations

from collections.abc import Callable
from math import log
from typing import NamedTuple, Protocol

import numpy as np
from scipy.optimize import minimize

from furuta_analysis.simulation.closed_loop import Loop, Simulation
from furuta_control.estimation import EstimatorParameters
from furuta_control.estimators.kalman import sample_kalman
from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.parameters import LuGre
from furuta_model.parameters import build, declared, values
from furuta_model.state import PHI, THETA
from furuta_studies.tuning.observed_friction import SCALES, fit_friction

# What the search moves by one of its units: a factor, or a difference where 0 is a value.
FACTORS = {
    "sigma0": 1.5,
    "sigma1": 1.5,
    "alpha0": 1.04,
    "alpha1": 1.6,
    "stribeck_velocity": 1.6,
}
DIFFERENCES = {"viscous": 0.01, "asymmetry": 0.05, "observer_gain": 0.02}
SEARCHABLE = (*FACTORS, *DIFFERENCES)
FITTED = tuple(SCALES)

# Pendulum time [s] of each step.
LOOK = 0.1
SETTLE = 2.0
WINDOW = 10.0
FIRST_SETTLE = 3.0
LISTEN = 12.0
LAST_WINDOW = 12.0
CANDIDATES = 3
# The search's first and last step, in its units.
FIRST_STEP, LAST_STEP = 0.6, 0.1


class TunableLoop(Protocol):
    """A pendulum in motion whose friction observer can be set and whose estimates be watched."""

    def apply(self, observer: ObserverParameters) -> None:
        """Set the friction observer's parameters."""

    def watch(self, seconds: float) -> np.ndarray:
        """Let the pendulum move on; the estimates (n, 5) of that time."""


class Plan(NamedTuple):
    """What is tuned, for how long, within which bounds.

    ``fit`` are read off the friction seen, ``search`` then tried out; ``seconds`` is the whole
    pendulum time, ``arm_guard`` [rad] the largest peak-to-peak excursion of the arm and
    ``pendulum_guard`` [rad] the largest angle of the pendulum that is tolerated.
    """

    fit: tuple[str, ...] = FITTED
    search: tuple[str, ...] = ("sigma1",)
    seconds: float = 200.0
    arm_guard: float = 1.0
    pendulum_guard: float = 0.4

    def check(self) -> None:
        """Raise :class:`ValueError` for names that cannot be tuned or too short a time."""
        for names, allowed in ((self.fit, FITTED), (self.search, SEARCHABLE)):
            unknown = [name for name in names if name not in allowed]
            if unknown:
                raise ValueError(f"{unknown[0]} is none of {', '.join(allowed)}")
        if self.seconds < self.shortest:
            raise ValueError(
                f"needs at least {self.shortest:g} s of pendulum time, given {self.seconds:g}"
            )

    @property
    def trials(self) -> int:
        """Candidates that the search can look at."""
        return int((self.seconds - self._fixed) // (SETTLE + WINDOW))

    @property
    def shortest(self) -> float:
        """The least pendulum time [s]: a search needs 2n + 1 candidates to begin."""
        return self._fixed + (2 * len(self.search) + 1) * (SETTLE + WINDOW)

    @property
    def _fixed(self) -> float:
        listening = FIRST_SETTLE + LISTEN
        return listening + SETTLE + WINDOW + CANDIDATES * (SETTLE + LAST_WINDOW)


class Trial(NamedTuple):
    """One candidate and the arm's peak-to-peak value [rad] that it left."""

    observer: ObserverParameters
    amplitude: float


class TuningResult(NamedTuple):
    """The outcome: amplitudes [rad] before and after, and the pendulum time [s] it took."""

    before: Trial
    fitted: LuGre
    after: Trial
    trials: list[Trial]
    seconds: float


class GuardError(Exception):
    """The motion left the guard."""


Report = Callable[[str, float], None]


def tune(
    rig: TunableLoop,
    start: ObserverParameters,
    estimator: EstimatorParameters,
    plan: Plan,
    report: Report,
) -> TuningResult:
    """Tune ``rig``'s LuGre compensator, which is left with the best parameters found.

    Raises :class:`GuardError` where the motion leaves the guard even with the parameters of the
    start, :class:`ValueError` where no friction is seen; then, as at any interruption, the
    parameters of the start are in force again.
    """
    plan.check()
    if not estimator.chosen.observes_friction:
        raise ValueError(
            f"the estimator's method must be kalman, which sees the friction; given "
            f"{estimator.method}"
        )
    try:
        return _Tuner(rig, start._replace(compensation="lugre"), plan, report).run(estimator)
    except BaseException:
        rig.apply(start)
        raise


class _Tuner:
    def __init__(
        self, rig: TunableLoop, start: ObserverParameters, plan: Plan, report: Report
    ) -> None:
        self._rig = rig
        self._start = start
        self._plan = plan
        self._report = report
        self._seconds = 0.0
        self._trials: list[Trial] = []

    def run(self, estimator: EstimatorParameters) -> TuningResult:
        before = self._trial(self._start, WINDOW)
        self._report(f"before: {before.amplitude:.4f} rad", self._seconds)
        fitted = self._listen(estimator)
        self._search(self._start._replace(friction=fitted))
        after = self._best()
        self._rig.apply(after.observer)
        return TuningResult(before, fitted, after, self._trials, self._seconds)

    def _best(self) -> Trial:
        """The best of the best trials, looked at again for all the time that is left."""
        best = sorted(self._trials, key=lambda trial: trial.amplitude)[:CANDIDATES]
        window = (self._plan.seconds - self._seconds) / len(best) - SETTLE
        last = []
        for number, each in enumerate(best, start=1):
            self._report(f"looking again at candidate {number} of {len(best)}", self._seconds)
            again = self._trial(each.observer, window)
            last.append(again._replace(amplitude=max(each.amplitude, again.amplitude)))
        return min(last, key=lambda trial: trial.amplitude)

    def _listen(self, estimator: EstimatorParameters) -> LuGre:
        """The friction's parameters from the limit cycle without compensation."""
        self._report("listening to the friction without compensation", self._seconds)
        self._rig.apply(self._start._replace(compensation="none"))
        self._watch(FIRST_SETTLE)
        estimates = self._watch(LISTEN)
        seen = fit_friction(
            estimates,
            sample_kalman(estimator.rig, estimator.kalman),
            estimator.sample_time,
            self._start.friction,
            self._plan.fit,
        )
        return seen.friction

    def _search(self, begin: ObserverParameters) -> None:
        if not self._plan.search:
            self._try(begin)
            return

        def amplitude(steps: np.ndarray) -> float:
            return log(self._try(_moved(begin, self._plan.search, steps)).amplitude)

        minimize(
            amplitude,
            np.zeros(len(self._plan.search)),
            method="COBYQA",
            options={
                "maxfev": self._plan.trials,
                "initial_tr_radius": FIRST_STEP,
                "final_tr_radius": LAST_STEP,
            },
        )

    def _try(self, observer: ObserverParameters) -> Trial:
        try:
            trial = self._trial(observer, WINDOW)
        except GuardError:
            trial = Trial(observer, self._plan.arm_guard)
            self._retreat()
        self._trials.append(trial)
        given = values(observer)
        tried = ", ".join(f"{name} {given[name]:.4g}" for name in self._plan.search)
        self._report(f"{tried}: {trial.amplitude:.4f} rad", self._seconds)
        return trial

    def _retreat(self) -> None:
        """Back to the best so far; if that leaves the guard too, the tuning is over."""
        self._report("left the guard", self._seconds)
        best = min(self._trials, key=lambda trial: trial.amplitude, default=None)
        self._rig.apply(best.observer if best else self._start)
        # What is still large from before may ring out; then the guard holds again.
        self._move(FIRST_SETTLE)
        self._watch(LOOK)

    def _trial(self, observer: ObserverParameters, window: float) -> Trial:
        self._rig.apply(observer)
        self._watch(SETTLE)
        return Trial(observer, float(np.ptp(self._watch(window)[:, PHI])))

    def _watch(self, seconds: float) -> np.ndarray:
        """The estimates of the next ``seconds``; :class:`GuardError` outside the guard."""
        low, high = np.inf, -np.inf
        parts = []
        for _ in range(int(seconds / LOOK + 1e-6)):
            part = self._move(LOOK)
            parts.append(part)
            low, high = min(low, part[:, PHI].min()), max(high, part[:, PHI].max())
            tilt = np.abs(part[:, THETA]).max()
            if high - low > self._plan.arm_guard or tilt > self._plan.pendulum_guard:
                raise GuardError(
                    f"arm {high - low:.2f} rad peak to peak, pendulum {tilt:.2f} rad; the guard is "
                    f"{self._plan.arm_guard:g} and {self._plan.pendulum_guard:g} rad"
                )
        return np.concatenate(parts)

    def _move(self, seconds: float) -> np.ndarray:
        self._seconds += seconds
        return self._rig.watch(seconds)


def _moved(
    observer: ObserverParameters, names: tuple[str, ...], steps: np.ndarray
) -> ObserverParameters:
    """The parameters moved by the search's steps, within what is allowed."""
    given = values(observer)
    for name, step in zip(names, steps, strict=True):
        factor = FACTORS.get(name)
        moved = given[name] * factor**step if factor else given[name] + DIFFERENCES[name] * step
        given[name] = float(min(max(moved, _ABOUT[name].low), _ABOUT[name].high))
    return build(ObserverParameters, given)


_ABOUT = {each.name: each.about for each in declared(ObserverParameters)}


class SimulatedLoop:
    """A simulated loop as a :class:`TunableLoop`."""

    def __init__(self, loop: Loop) -> None:
        self._simulation = Simulation(loop)

    def apply(self, observer: ObserverParameters) -> None:
        """Set the friction observer's parameters between two samples."""
        self._simulation.loop = self._simulation.loop._replace(observer=observer)

    def watch(self, seconds: float) -> np.ndarray:
        """Simulate on; the estimates (n, 5)."""
        return self._simulation.run(seconds).estimate
