"""Compares friction compensations on an axis, and recommends one.

Each candidate knows the friction of the model, but the true friction is smaller or larger: what
suits one level only is no recommendation.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from furuta.axis.axis import Axis, Controller, poles, servo_cycle
from furuta.axis.simulation import MOST_SAMPLES, simulate_axis
from furuta.limit_cycles.joint import JointCycle
from furuta_friction.compensation import COMPENSATIONS
from furuta_model.parameters import ParameterError
from furuta_model.progress import Progress, unseen

# True levels of friction, relative to those that the compensators assume.
LEVELS = (0.8, 1.0, 1.25)
# First length of a simulation in periods of the cycle and in time constants of the slowest pole,
# and its limits [s]. It is doubled until the errors of its third and fourth quarter differ by no
# more than a part, or a count.
PERIODS, TIME_CONSTANTS = 12.0, 8.0
SHORTEST, LONGEST = 10.0, 600.0
SETTLED = 0.1
# An error above the smallest one that is as good: by this factor, or by half a count.
AS_GOOD = 1.1


class Residual(NamedTuple):
    """What remains with a compensation, the worst over the true levels of friction [rad].

    ``settled`` says whether the error does not change any more. ``chatter_nm`` is the root mean
    square change [N m] of the torque from sample to sample.
    """

    compensation: str
    error_rad: float
    peak_to_peak_rad: float
    chatter_nm: float
    settled: bool


class AxisComparison(NamedTuple):
    """The residual of each candidate, and the recommended one: the simplest of the best.

    If none has settled, the recommended one has not either.
    """

    residuals: tuple[Residual, ...]
    recommended: Residual


def compare_on_axis(
    axis: Axis,
    controller: Controller,
    *,
    speed: float = 0.0,
    counts: int = 4096,
    sample_time: float = 1e-3,
    delay: float = 0.0,
    by_topic: bool = False,
    largest_chatter: float = np.inf,
    cycle: JointCycle | None = None,
    others: Sequence[Axis] = (),
    progress: Progress = unseen,
) -> AxisComparison:
    """Simulate an axis with each compensation, and recommend one.

    The true friction is 0.8, 1 and 1.25 times that which the compensators assume, and that of
    ``others``. The encoder has ``counts`` per turn, 0 for a perfect one; with ``by_topic`` F̂ comes
    a sample late. A compensation is recommended up to the ``largest_chatter`` [N m]. ``cycle`` is
    the motion without one, if it is known.

    Raises :class:`ParameterError` if the axis is unbounded or a number is not allowed.
    """
    cycle = cycle or servo_cycle(axis, controller, speed)
    if cycle.kind == "unbounded":
        raise ParameterError("the axis is unbounded without compensation: change the gains")
    options: dict[str, Any] = {
        "speed": speed,
        "counts": counts,
        "sample_time": sample_time,
        "delay": delay,
        "by_topic": by_topic,
        "period": cycle.period_s,
    }
    trues = (*(with_level(axis, level) for level in LEVELS), *others)
    residuals = []
    for compensation in progress(COMPENSATIONS, len(COMPENSATIONS)):
        found = [residual(true, axis, controller, compensation, **options) for true in trues]
        _, errors, sizes, chatters, settled = zip(*found, strict=True)
        worst = max(errors), max(sizes), max(chatters)
        residuals.append(Residual(compensation, *worst, all(settled)))
    quiet = [each for each in residuals if each.chatter_nm <= largest_chatter] or residuals
    final = [each for each in quiet if each.settled] or quiet
    best = min(each.error_rad for each in final)
    if not np.isfinite(best):
        raise ParameterError(
            f"the simulated axis leaves all bounds: {counts} counts per turn or the gains do not "
            "suit it"
        )
    good = max(AS_GOOD * best, best + (np.pi / counts if counts else 0.0))
    return AxisComparison(tuple(residuals), next(r for r in final if r.error_rad <= good))


def residual(
    true: Axis,
    model: Axis,
    controller: Controller,
    compensation: str,
    *,
    speed: float = 0.0,
    counts: int = 4096,
    sample_time: float = 1e-3,
    delay: float = 0.0,
    by_topic: bool = False,
    period: float = np.nan,
) -> Residual:
    """What remains on the ``true`` axis with a compensation that knows the ``model``.

    It is simulated until the error has settled, or for :data:`LONGEST`; with the ``period`` [s] of
    the cycle without compensation, if there is one, for several periods.
    """
    needed = _first_length(model, controller, period)
    longest = min(LONGEST, MOST_SAMPLES * sample_time)
    smallest = 2.0 * np.pi / counts if counts else 0.0
    seconds = min(needed, longest)
    while True:
        record = simulate_axis(
            true,
            controller,
            seconds=seconds,
            reference=speed,
            compensation=compensation,
            model=model,
            counts=counts,
            sample_time=sample_time,
            delay=delay,
            by_topic=by_topic,
        )
        quarters = np.array_split(record.error, 4)[2:]
        each = np.array([(np.abs(part).max(), np.ptp(part)) for part in quarters])
        largest = each.max(axis=0)
        agree = np.all(np.ptp(each, axis=0) <= np.maximum(SETTLED * largest, smallest))
        settled = bool(agree and needed <= longest)
        if settled or seconds >= longest:
            steps = np.diff(record.torque[len(record.torque) // 2 :])
            chatter = float(np.sqrt(np.mean(steps**2)))
            return Residual(compensation, float(largest[0]), float(largest[1]), chatter, settled)
        seconds = min(2.0 * seconds, longest)


def with_level(axis: Axis, factor: float) -> Axis:
    """The axis with larger or smaller levels of dry friction."""
    p = axis.friction
    return axis._replace(friction=p._replace(alpha0=factor * p.alpha0, alpha1=factor * p.alpha1))


def _first_length(axis: Axis, controller: Controller, period: float) -> float:
    """Simulated time [s] in which the axis probably reaches its final motion."""
    rates = np.abs(poles(axis, controller).real)
    slowest = float(rates[rates > 1e-9 * rates.max()].min(initial=np.inf))
    of_period = min(PERIODS * period, LONGEST) if period > 0.0 else 0.0
    return max(SHORTEST, of_period, TIME_CONSTANTS / slowest)
