"""Tuning of the compensation by the arm's swing, on a pendulum in motion, simulated or real.

The recommended setting is tried with one change at a time: the bandwidth with which friction is
observed, the lag that is known of the drive, and a presliding that is kept instead of learned. The
level of the friction it learns by itself. The swing is the arm's estimated angle, peak to peak,
which a real rig provides too.

1. The motion is measured as it is, then with the recommended setting.
2. While the swing is too large, other settings are tried, each with one change to the best.
   A swing that stays large is measured without compensation too.
3. A trial counts as small enough, by default a count of the encoder, only after a longer
   measurement. Otherwise the best one is measured once more. If the motion as it was is not worse,
   nothing changes.

Safety: the excursion is checked every tenth of a second. Where it leaves the guard, or grows beyond
the best one so far, the best setting is restored and the search goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf, sqrt
from typing import Protocol

import numpy as np

from furuta.studies.trials import (
    AS_IT_IS,
    LEARNED,
    NONE,
    RECOMMENDED,
    Compensation,
    Trial,
    TuningResult,
    swing_of,
)
from furuta.studies.tuning_plan import (
    CALM,
    CONFIRMING,
    GUARD_INTERVAL,
    LONGEST,
    MEASURING,
    RECOVERY,
    SETTLING,
    STARTING,
    TuningPlan,
)
from furuta_friction.compensation import ObserverParameters, design_compensator
from furuta_friction.disturbance_observer import limited
from furuta_friction.learned_friction import LearningParameters
from furuta_model.friction.lugre import highest_level
from furuta_model.parameters import ParameterError
from furuta_model.state import THETA
from furuta_sim.simulation.closed_loop import Loop, Simulation

# Called with a message and the pendulum time [s].
ProgressCallback = Callable[[str, float], None]

# The usual bandwidth [1/s].
USUAL = ObserverParameters().bandwidth
# One count without quantisation [rad].
SMALLEST_COUNT = 1e-3
# Relative difference of two lags or scales.
DIFFERENT = 0.2
# Scales of the bandwidth that are tried at first and later; lags of the drive [s].
SMALLER, LARGER, LAGS = 0.7, (2.0, 1.4), (0.006, 0.012, 0.025)
# Swing, relative to the best one, below which a trial is better, and from which it is given up.
BETTER, GROWN = 0.9, 1.3
# Swing in counts of the encoder from which no compensation may be better.
LARGE = 2.0
# Swing in the second half of a measurement, relative to all, below which it begins again.
DECAYING = 0.5


class TunableLoop(Protocol):
    """A closed loop in operation, simulated or real."""

    def apply(self, compensation: Compensation) -> None:
        """Set the parameters of estimator, friction observer and controller."""

    def watch(self, seconds: float) -> np.ndarray:
        """Let the pendulum move on, and return the estimates (n, 5) of that time."""


class SimulatedLoop:
    """A simulation as a :class:`TunableLoop`."""

    def __init__(self, loop: Loop) -> None:
        self._simulation = Simulation(loop)

    def apply(self, compensation: Compensation) -> None:
        """Set the parameters between two samples."""
        self._simulation.loop = self._simulation.loop._replace(**compensation._asdict())

    def watch(self, seconds: float) -> np.ndarray:
        """Continue the simulation, and return the estimates (n, 5)."""
        return self._simulation.run(seconds).estimate


class GuardError(ParameterError):
    """The motion left the guard, and no setting brought it back."""


def tune(
    rig: TunableLoop,
    start: Compensation,
    plan: TuningPlan,
    report: ProgressCallback,
    follow: float = 0.0,
) -> TuningResult:
    """Tune the compensation of ``rig`` and leave it with the best one found.

    After that the swing is watched for ``follow`` [s], and the search begins again whenever it has
    grown. Raises :class:`GuardError` if the pendulum falls. The initial parameters are then
    restored, as after any interruption.
    """
    plan.check()
    tuner = Tuner(rig, start, plan, report)
    try:
        return tuner.follow(follow, tuner.run())
    except BaseException:
        rig.apply(start)
        raise


def tune_simulated(loop: Loop, plan: TuningPlan, report: ProgressCallback) -> TuningResult:
    """Tune a simulated loop."""
    start = Compensation(loop.estimator, loop.observer, loop.controller)
    return tune(SimulatedLoop(loop), start, plan, report)


class Tuner:
    """A search on one rig."""

    def __init__(
        self, rig: TunableLoop, start: Compensation, plan: TuningPlan, report: ProgressCallback
    ) -> None:
        self._rig, self._start, self._plan, self._report = rig, start, plan, report
        self._count = start.estimator.sensors.encoder_count or SMALLEST_COUNT
        self._enough = plan.enough * self._count
        self._trials: list[Trial] = []
        self._elapsed = 0.0

    def run(self) -> TuningResult:
        """Find the compensation with the least swing, and apply it."""
        self._advance(STARTING)
        before = self._try(self._as_it_is)
        self._try_new(1.0, before.lag, LEARNED)
        if self._best().swing == inf:
            raise self._left_guard("every trial")
        self._search()
        after = self._confirmed()
        return TuningResult(before, after, self._trials, self._elapsed, self._count)

    def follow(self, seconds: float, result: TuningResult) -> TuningResult:
        """Search again whenever the swing has grown, until ``seconds`` have passed."""
        best, end, plan = result.after, self._elapsed + seconds, self._plan
        while self._elapsed < end:
            self._trials = [best]
            if self._try(best).swing > self._grown():
                self._trials = []
                self._try(best._replace(swing=inf))
                self._plan = plan._replace(seconds=self._elapsed + plan.seconds)
                self._try_new(1.0, best.lag, LEARNED)
                self._search()
                best = self._confirmed()
            result.trials.extend(self._trials)
        return replace(result, after=best, seconds=self._elapsed)

    @property
    def _as_it_is(self) -> Trial:
        """The initial parameters."""
        observer = self._start.observer
        known = observer.compensation in (NONE, RECOMMENDED)
        name = observer.compensation if known else AS_IT_IS
        kept = name == RECOMMENDED and observer.learning.presliding_rate == 0.0
        presliding = float(highest_level(observer.friction)) / observer.friction.sigma0
        scale = observer.bandwidth / USUAL
        return Trial(name, scale, observer.drive.lag, presliding if kept else LEARNED, self._start)

    def _recommended(self, scale: float, lag: float, presliding: float = LEARNED) -> Trial:
        """The recommended setting with another bandwidth, for another lag, with a presliding."""
        estimator, observer, controller = self._start
        drive = observer.drive._replace(lag=lag)
        learning, friction = observer.learning, observer.friction
        if presliding != LEARNED:
            friction = friction._replace(sigma0=float(highest_level(friction)) / presliding)
            learning = learning._replace(presliding_rate=0.0)
        elif not learning.presliding_rate:
            learning = learning._replace(presliding_rate=LearningParameters().presliding_rate)
        changed = Compensation(
            estimator._replace(drive=drive),
            observer._replace(
                compensation=RECOMMENDED,
                bandwidth=scale * USUAL,
                drive=drive,
                friction=friction,
                learning=learning,
            ),
            controller._replace(balance=controller.balance._replace(strength=1.0)),
        )
        return Trial(RECOMMENDED, scale, lag, presliding, changed)

    def _search(self) -> None:
        """Try other settings, with one change at a time, until the swing is small enough.

        What is better with a smaller bandwidth may be elastic; what is worse, late.
        """
        self._change(scale=SMALLER)
        self._try_none()
        searches = self._keep_presliding, self._expect_lateness
        for search in searches if self._best(RECOMMENDED).scale < 1.0 else reversed(searches):
            search()

    def _keep_presliding(self) -> None:
        learning = design_compensator(self._start.observer).predictive.learning
        middle = sqrt(learning.smallest * learning.largest)
        for presliding in (middle, learning.smallest, learning.largest):
            self._change(scale=SMALLER, presliding=presliding)

    def _expect_lateness(self) -> None:
        for scale in LARGER:
            self._change(scale=scale)
        for lag in LAGS:
            self._change(lag=lag)

    def _change(self, **change: float) -> None:
        """Try the best recommended setting with a change."""
        best = self._best(RECOMMENDED)
        setting = {"scale": best.scale, "lag": best.lag, "presliding": best.presliding}
        self._try_new(**(setting | change))

    def _try_none(self) -> None:
        """Try no compensation, if the swing is large and that is not known."""
        tried = any(trial.name == NONE for trial in self._trials)
        if self._best().swing > LARGE * self._count and not tried and self._has_time(LONGEST):
            observer = self._start.observer._replace(compensation=NONE)
            none = self._start._replace(observer=observer)
            self._try(self._as_it_is._replace(name=NONE, compensation=none))

    def _try_new(self, scale: float, lag: float, presliding: float) -> None:
        """Try a setting, unless that is not needed, known, or too late."""
        bandwidth = self._acting(scale)
        known = any(
            abs(self._acting(trial.scale) / bandwidth - 1.0) < DIFFERENT
            and abs(trial.lag - lag) <= DIFFERENT * lag
            and trial.presliding == presliding
            for trial in self._trials
            if trial.name == RECOMMENDED
        )
        needed = self._best().swing > self._enough
        if needed and not known and self._has_time(LONGEST):
            self._try(self._recommended(scale, lag, presliding))

    def _acting(self, scale: float) -> float:
        """The bandwidth [1/s] of a scale that acts with this sample time."""
        return limited(scale * USUAL, self._start.observer.sample_time)

    def _has_time(self, seconds: float = 0.0) -> bool:
        """Whether ``seconds`` are left before the last measurement."""
        return self._elapsed + seconds + SETTLING + CONFIRMING <= self._plan.seconds

    def _best(self, name: str = "") -> Trial:
        """The best trial, of a compensation if there is a name; else the standard one, unknown."""
        trials = [trial for trial in self._trials if name in ("", trial.name)]
        standard = self._recommended(1.0, self._start.observer.drive.lag)
        best = min(trials, key=lambda trial: (trial.given_up, trial.swing), default=standard)
        return standard if best.swing == inf else best

    def _confirmed(self) -> Trial:
        """The best trial after a longer measurement; it is applied."""
        confirmed: list[Trial] = []
        while (best := self._best()) not in confirmed and best.swing > self._enough:
            if best.swing == inf or not self._has_time():
                break
            swing = self._measured(best, CONFIRMING, inf).swing
            confirmed.append(best._replace(swing=max(best.swing, swing)))
            self._trials[self._trials.index(best)] = confirmed[-1]
        first = self._trials[0]
        if first.swing < inf and best.swing > BETTER * first.swing:
            best = best if best.swing <= self._enough < first.swing else first
        if best.swing == inf:
            raise self._left_guard("every trial")
        self._rig.apply(best.compensation)
        return best

    def _try(self, trial: Trial) -> Trial:
        """Measure a trial; if it swings more than the best one, go back to that."""
        grown = self._grown()
        trial = self._measured(trial, MEASURING, grown)
        self._trials.append(trial)
        self._report(str(trial), self._elapsed)
        if trial.swing > grown:
            self._go_back()
        return trial

    def _grown(self) -> float:
        """Swing of a trial [rad] from which it is given up."""
        best = self._best().swing
        return max(GROWN * best, best + self._count)

    def _measured(self, trial: Trial, seconds: float, grown: float) -> Trial:
        """A trial with its swing, measured for longer if that is near enough."""
        self._rig.apply(trial.compensation)
        seen: list[np.ndarray] = []
        inside = self._watch(SETTLING, 2.0 * grown, seen)
        if inside and swing_of(seen) <= 2.0 * grown:
            seen = []
            inside = self._watch(seconds, grown, seen)
        first = inside and seconds < CONFIRMING
        if first and swing_of(seen[len(seen) // 2 :]) < DECAYING * swing_of(seen):
            seen = []
            inside = self._watch(seconds, grown, seen)
        if first and inside and swing_of(seen) <= self._enough:
            inside = self._watch(CONFIRMING, grown, seen)
        swing = swing_of(seen) if inside else inf
        return trial._replace(swing=swing, given_up=bool(grown < swing < inf))

    def _watch(self, seconds: float, grown: float, seen: list[np.ndarray]) -> bool:
        """Append estimates to ``seen`` until it has ``grown``; whether it is inside the guard."""
        for _ in range(round(seconds / GUARD_INTERVAL)):
            seen.append(self._advance(GUARD_INTERVAL))
            swing = swing_of(seen)
            if swing > self._plan.arm_guard or not self._is_upright(seen[-1]):
                return False
            if swing > grown:
                break
        return True

    def _advance(self, seconds: float) -> np.ndarray:
        self._elapsed += seconds
        return self._rig.watch(seconds)

    def _is_upright(self, estimates: np.ndarray) -> bool:
        return bool(np.max(np.abs(estimates[:, THETA])) <= self._plan.pendulum_guard)

    def _go_back(self) -> None:
        """Apply the best trial so far; if the pendulum has fallen, tuning ends."""
        best = self._best()
        self._rig.apply(best.compensation)
        for _ in range(CALM):
            last = self._advance(RECOVERY)
            if swing_of([last]) <= best.swing + self._count and self._is_upright(last):
                return
        if not self._is_upright(last):
            raise self._left_guard("the pendulum")

    def _left_guard(self, what: str) -> GuardError:
        arm, pendulum = self._plan.arm_guard, self._plan.pendulum_guard
        return GuardError(
            f"{what} left the guard of {arm:g} rad of the arm and {pendulum:g} rad (arm-guard, "
            "pendulum-guard); the initial parameters are restored; begin with another setting"
        )
