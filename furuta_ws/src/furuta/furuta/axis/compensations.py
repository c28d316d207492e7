"""Compares friction compensations on an axis, and recommends one.

Each candidate knows the friction of the model, but the true friction is smaller or larger, or the
torque acts a sample later: what suits one of them only is no recommendation. Nor is what does not
halve the error. On an axis that hunts, the last candidate has no integral action: the compensation
observes the torque that holds the axis, so it does what the integral should, which only disturbs.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from furuta.axis.axis import HUNTING, Axis, Controller, poles, servo_cycle, without_integral
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
PERIODS, TIME_CONSTANTS = 4.0, 8.0
SHORTEST, LONGEST = 10.0, 600.0
SETTLED = 0.1
# An error above the smallest one that is as good: by this factor, or by half a count.
AS_GOOD = 1.1
# What a compensation leaves at most, relative to none, to be worth it; or so many counts.
WORTH, COUNTS = 0.5, 2.0
# Starts of an axis that hunts, relative to a release from far away. A compensation may end in
# another motion from some of them.
STARTS = tuple(side * 10.0 ** (-k / 3.0) for k in range(7) for side in (1.0, -1.0))


class Residual(NamedTuple):
    """What remains with a compensation [rad], the worst of the true axes that were simulated.

    ``settled`` says whether the error does not change any more. ``chatter_nm`` is the root mean
    square change [N m] of the torque from sample to sample. Without ``integral`` the controller has
    no integral action. What is not ``worth`` it has failed with one of the axes, and was not tried
    with those that remained.
    """

    compensation: str
    error_rad: float
    peak_to_peak_rad: float
    chatter_nm: float
    settled: bool
    integral: bool = True
    worth: bool = False


class AxisComparison(NamedTuple):
    """The residual of each candidate, and the simplest of the best that are worth it, or none."""

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
    ``others``; then the torque is late by a sample more. The encoder has ``counts`` per turn, 0 for
    a perfect one; with ``by_topic`` F̂ comes a sample late. A compensation is worth it if it halves
    error and peak to peak with a chatter of at most ``largest_chatter`` [N m]. ``cycle`` is the
    motion without one, if it is known.

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
    hunts, still = cycle.kind in HUNTING and not speed, COUNTS * 2.0 * np.pi / max(counts, 1)
    trues = [(axis, sample_time), *((with_level(axis, level), 0.0) for level in LEVELS)]
    runs = [
        {"true": true, "late": late, "start": start}
        for true, late in (*trues, *((other, 0.0) for other in others))
        for start in (STARTS if hunts else STARTS[:1])
    ]
    released = [run for run in runs if run["start"] == STARTS[0]]
    none = _worst(
        [residual(model=axis, controller=controller, **run, **options) for run in released]
    )
    if not np.isfinite(none.error_rad):
        raise ParameterError(
            f"the simulated axis leaves all bounds: {counts} counts per turn or the gains do not "
            "suit it"
        )
    if hunts:  # it may have been simulated while it was stuck
        size = max(none.peak_to_peak_rad, cycle.peak_to_peak)
        error = max(none.error_rad, 0.5 * size)
        none = none._replace(error_rad=error, peak_to_peak_rad=size, settled=True)
    bounds = WORTH * none.error_rad, max(WORTH * none.peak_to_peak_rad, still if counts else 0.0)
    candidates = [(name, controller) for name in COMPENSATIONS if name != "none"]
    if hunts:
        candidates.append(("recommended", without_integral(controller)))
    residuals = [none]
    for compensation, gains in progress(candidates, len(candidates)):
        options |= {"compensation": compensation, "controller": gains, "bounds": bounds}
        found: list[Residual] = []
        for run in runs:
            found.append(residual(model=axis, **run, **options))
            worst = _worst(found)
            sizes = worst.error_rad, worst.peak_to_peak_rad, worst.chatter_nm
            worth = worst.settled and np.all(np.array(sizes) <= (*bounds, largest_chatter))
            if not worth:
                break
        residuals.append(worst._replace(integral=gains == controller, worth=bool(worth)))
    worth_it = [each for each in residuals if each.worth]
    best = min((each.error_rad for each in worth_it), default=0.0)
    good = max(AS_GOOD * best, best + (np.pi / counts if counts else 0.0))
    return AxisComparison(
        tuple(residuals), next((each for each in worth_it if each.error_rad <= good), none)
    )


def _worst(found: Sequence[Residual]) -> Residual:
    """The largest error, peak to peak and chatter of several runs; whether all have settled."""
    _, errors, sizes, chatters, settled, _, _ = zip(*found, strict=True)
    return Residual(found[0][0], max(errors), max(sizes), max(chatters), all(settled))


def residual(
    true: Axis,
    model: Axis,
    controller: Controller,
    compensation: str = "none",
    *,
    speed: float = 0.0,
    counts: int = 4096,
    sample_time: float = 1e-3,
    delay: float = 0.0,
    by_topic: bool = False,
    period: float = np.nan,
    start: float = 1.0,
    late: float = 0.0,
    bounds: tuple[float, float] = (np.inf, np.inf),
) -> Residual:
    """What remains on the ``true`` axis with a compensation that knows the ``model``.

    It is simulated until the error has settled, or for :data:`LONGEST`; with the ``period`` [s] of
    the cycle without compensation, if there is one, for several periods. If error or peak to peak
    are then beyond ``bounds``, that is enough. ``start`` and ``late`` are those of
    :func:`furuta.axis.simulation.simulate_axis`.
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
            start=start,
            late=late,
        )
        quarters = np.array_split(record.error, 4)[2:]
        each = np.array([(np.abs(part).max(), np.ptp(part)) for part in quarters])
        largest = each.max(axis=0)
        agree = np.all(np.ptp(each, axis=0) <= np.maximum(SETTLED * largest, smallest))
        settled = bool(agree and needed <= longest)
        if settled or seconds >= longest or np.any(largest > bounds):
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
