"""Tuning of the compensation by the arm's swing, on a pendulum in motion, simulated or real.

A compensation is tried with one scale at a time: the strength of the recommended setting, the level
of Coulomb and stiction compensation, σ₁ of LuGre. The swing is the arm's estimated angle, peak to
peak, which a real rig provides too.

1. The motion is measured as it is, and with less and less strength. Where the pendulum stands with
   little, it is measured without compensation. While the arm slides then, the estimator observes
   the friction's level.
2. Each compensation starts from this level. While the swing is beyond eight counts of the encoder,
   its scale changes by factors of four, because the minimum can be far away. Then it changes
   by factors of two and less. Once the swing is small enough, by default a count, the search ends.
3. A trial counts as small enough only after a longer measurement. Otherwise the best one is
   measured once more. If the motion as it was is not worse, nothing changes.

Safety: the excursion is checked every tenth of a second. Where it leaves the guard, or grows beyond
the best one so far, the best setting is restored and the search goes on, but not beyond that scale.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf, sqrt
from typing import Protocol

import numpy as np

from furuta.settings.recommended import RECOMMENDED
from furuta.studies.trials import (
    AS_IT_IS,
    NONE,
    Compensation,
    Trial,
    TuningResult,
    is_twisting,
    observed_friction,
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
from furuta_control.estimation import EstimatorParameters
from furuta_model.friction.parameters import SMALLEST_LEVEL
from furuta_model.parameters import ParameterError
from furuta_model.state import THETA
from furuta_sim.simulation.closed_loop import Loop, Simulation

# Called with a message and the pendulum time [s].
ProgressCallback = Callable[[str, float], None]

# Swing [counts] from which the scale changes coarsely; the factors. One count without quantisation
# [rad].
FAR = 8.0
COARSE, FINE = (1 / 4, 1 / 16, 4.0), (2.0, sqrt(2.0))
SMALLEST_COUNT = 1e-3
# Swing without compensation that shows the friction [rad]; strength that is nearly none.
SHOWN, LITTLE = 0.2, 0.2
# Swing, relative to the best one, below which a trial is better, from which it is given up, and
# from which a compensation is not tried further.
BETTER, GROWN, HOPELESS = 0.9, 1.3, 2.0
# Swing in the second half of a measurement, relative to all, below which it begins again.
DECAYING = 0.5
# Scales that are allowed, and those from the observed level; relative difference of two scales.
SCALES, FROM_LEVEL, DIFFERENT = (0.02, 4.0), (0.05, 2.0), 0.05


class TunableLoop(Protocol):
    """A closed loop in operation, simulated or real."""

    def apply(self, compensation: Compensation) -> None:
        """Set the parameters of friction observer and controller."""

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
    estimator: EstimatorParameters,
    plan: TuningPlan,
    report: ProgressCallback,
    follow: float = 0.0,
) -> TuningResult:
    """Tune the compensation of ``rig`` and leave it with the best one found.

    After that the swing is watched for ``follow`` [s], and the strength is searched again whenever
    it has grown. Raises :class:`GuardError` if the pendulum falls. The initial parameters are then
    restored, as after any interruption.
    """
    plan.check()
    tuner = Tuner(rig, start, estimator.sensors.encoder_count, plan, report)
    try:
        return tuner.follow(follow, tuner.run())
    except BaseException:
        rig.apply(start)
        raise


def tune_simulated(loop: Loop, plan: TuningPlan, report: ProgressCallback) -> TuningResult:
    """Tune a simulated loop."""
    start = Compensation(loop.observer, loop.controller)
    return tune(SimulatedLoop(loop), start, loop.estimator, plan, report)


class Tuner:
    """A search on one rig; ``count`` [rad] is that of the arm's encoder."""

    def __init__(
        self,
        rig: TunableLoop,
        start: Compensation,
        count: float,
        plan: TuningPlan,
        report: ProgressCallback,
    ) -> None:
        self._rig, self._start, self._plan, self._report = rig, start, plan, report
        self._count = count or SMALLEST_COUNT
        self._enough, self._far = plan.enough * self._count, FAR * self._count
        self._known = start.observer.friction  # with the level that has been observed
        self._trials: list[Trial] = []
        self._elapsed = 0.0

    def run(self) -> TuningResult:
        """Find the compensation with the least swing, and apply it."""
        self._advance(STARTING)
        before = self._try(self._as_it_is)
        if RECOMMENDED in self._plan.compensations:
            self._try_scale(RECOMMENDED, 1.0 if before.swing == inf else before.scale or 1.0)
            if self._best().swing == inf:
                raise self._left_guard("every trial")
            self._search(RECOMMENDED, 0.5 * self._best(RECOMMENDED).scale)
        needed = self._best().swing > self._enough and before.name != NONE
        if needed and self._is_none_safe() and self._has_time(LONGEST):
            self._try(self._candidate(NONE, 0.0))
        for name in self._plan.compensations:
            self._search(name, self._level if name == RECOMMENDED else 1.0)
        after = self._confirmed()
        return TuningResult(before, after, self._trials, self._elapsed, self._count)

    def _is_none_safe(self) -> bool:
        """Whether the pendulum stands with little compensation, which is not so on every belt."""
        least = min(self._tried(RECOMMENDED), key=lambda trial: trial.scale, default=None)
        return least is None or (least.scale <= LITTLE and least.is_inside)

    def follow(self, seconds: float, result: TuningResult) -> TuningResult:
        """Search the strength again whenever the swing has grown, until ``seconds`` have passed."""
        best, end, plan = result.after, self._elapsed + seconds, self._plan
        while self._elapsed < end:
            # None may swing more in a search, in which it shows the friction.
            best = best._replace(name=AS_IT_IS) if best.name == NONE else best
            self._trials = [best]
            if self._try(best).swing > self._grown(best):
                self._trials = []
                strength = self._try(best._replace(swing=inf)).scale
                self._plan = plan._replace(seconds=self._elapsed + plan.seconds)
                self._search(RECOMMENDED, strength if best.name == RECOMMENDED else LITTLE)
                best = self._confirmed()
            result.trials.extend(self._trials)
        return result._replace(after=best, seconds=self._elapsed)

    @property
    def _as_it_is(self) -> Trial:
        """The initial parameters."""
        if (
            self._start.observer.compensation == NONE
            and not self._start.controller.balance.super_twisting
        ):
            return Trial(NONE, 0.0, self._start)
        if is_twisting(self._start):
            return Trial(RECOMMENDED, self._start.controller.balance.strength, self._start)
        return Trial(AS_IT_IS, 1.0, self._start)

    @property
    def _level(self) -> float:
        """The observed level of friction, relative to that of the model."""
        level = self._known.alpha0 / max(self._start.observer.friction.alpha0, SMALLEST_LEVEL)
        return min(max(level, FROM_LEVEL[0]), FROM_LEVEL[1])

    def _candidate(self, name: str, scale: float) -> Trial:
        """A compensation to try; all but the recommended one have the observed level."""
        observer, controller = self._start
        changed = {"strength": 1.0, "super_twisting": 0.0}
        if name == NONE:
            changed = {"strength": 0.0}
        elif name == RECOMMENDED:
            if not is_twisting(self._start):
                controller = with_super_twisting(controller, observer)
            changed = {"strength": scale}
            observer = observer._replace(compensation="lugre")
        else:
            scaled = ("sigma1",) if name == "lugre" else ("alpha0", "alpha1")
            changes = {each: scale * getattr(self._known, each) for each in scaled}
            known = self._known._replace(**changes)
            observer = observer._replace(compensation=name, friction=known)
        balance = controller.balance._replace(**changed)
        controller = controller._replace(balance=balance)
        return Trial(name, scale, Compensation(observer, controller))

    def _search(self, name: str, first: float) -> None:
        """Change the scale of a compensation until the swing is near enough."""
        self._try_scale(name, first)
        for factor in COARSE:
            if self._best().swing > self._far:
                self._try_scale(name, factor * first)
        for step in FINE:
            for factor in (1.0 / step, step):
                while self._improves(name, factor):
                    pass

    def _improves(self, name: str, factor: float) -> bool:
        """Whether the best scale, changed by a factor, is better."""
        best = self._best(name)
        low, high = sorted((best.scale, factor * best.scale))
        # Beyond a scale that was given up, a belt may let the pendulum fall.
        beyond = any(low < t.scale < high and not t.is_inside for t in self._tried(name))
        if best.swing <= HOPELESS * self._best().swing and not beyond:
            self._try_scale(name, factor * best.scale)
        return self._best(name).swing < BETTER * best.swing

    def _try_scale(self, name: str, scale: float) -> None:
        """Try a scale, unless that is not needed, not allowed, known, or too late."""
        known = any(abs(trial.scale / scale - 1.0) < DIFFERENT for trial in self._tried(name))
        allowed = SCALES[0] <= scale <= SCALES[1]
        needed = self._best().swing > self._enough
        if needed and allowed and not known and self._has_time(LONGEST):
            self._try(self._candidate(name, scale))

    def _has_time(self, seconds: float = 0.0) -> bool:
        """Whether ``seconds`` are left before the last measurement."""
        return self._elapsed + seconds + SETTLING + CONFIRMING <= self._plan.seconds

    def _tried(self, name: str) -> list[Trial]:
        """The trials of a compensation."""
        return [trial for trial in self._trials if trial.name == name]

    def _best(self, name: str = "") -> Trial:
        """The best trial, of a compensation if there is a name; else the standard one, unknown."""
        trials = self._tried(name) if name else self._trials
        standard = self._candidate(RECOMMENDED, 1.0)
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
        if self._trials[0].swing < inf and best.swing > BETTER * self._trials[0].swing:
            best = self._trials[0]
        if best.swing == inf:
            raise self._left_guard("every trial")
        self._rig.apply(best.compensation)
        return best

    def _try(self, trial: Trial) -> Trial:
        """Measure a trial; if it swings more than the best one, go back to that."""
        grown = self._grown(trial)
        trial = self._measured(trial, MEASURING, grown)
        self._trials.append(trial)
        self._report(str(trial), self._elapsed)
        if trial.swing > grown or trial.name == NONE:
            self._go_back()
        return trial

    def _grown(self, trial: Trial) -> float:
        """Swing of a trial [rad] from which it is given up."""
        best = self._best().swing
        return max(GROWN * best, SHOWN if trial.name == NONE else best + self._count)

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
        if trial.name == NONE:
            self._known = observed_friction(np.concatenate(seen), self._known)
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
            "pendulum-guard); the initial parameters are restored; begin with another strength"
        )
