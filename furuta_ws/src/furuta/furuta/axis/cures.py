r"""What ends the hunting of an axis behind a reference at rest, without a compensation.

The integral rests while the error is small, is reset where the error changes its sign, and is
limited while the axis moves. An integral whose torque :math:`u_i` stays below a limit L < α₀ gives
a sliding axis less energy than friction takes,

.. math:: \dot V = v\,(u_i - F) - k_d v^2 ≤ -(α_0 - L)\,|v|, \qquad
    V = \tfrac12 J v^2 + \tfrac12 k_p e^2 ,

so it slides a finite way, from any start and with any Stribeck curve. But samples and encoder
notice a breakaway late, so each rule is simulated (:mod:`furuta.axis.slips`): from all starts, with
friction 0.8, 1 and 1.25 times as large, and with a sample more of delay. Outside the dead band the
integral would move the axis, so the dead band is the largest error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import inf, log, pi
from typing import Any, NamedTuple

import numpy as np

from furuta.axis.axis import NO_RULE, Axis, Controller, IntegralRule, without_integral
from furuta.axis.compensations import AS_GOOD, LEVELS, with_level
from furuta.axis.slips import rests_after
from furuta_model.friction.lugre import highest_level
from furuta_model.progress import Progress, unseen

# Step of the dead bands that are tried, and the smallest for a perfect sensor, relative to the
# error that friction can hold.
STEP, SMALLEST = 1.25, 1e-3
# Limit of the integral's torque while the axis moves, relative to the Coulomb level; below the
# lowest of LEVELS.
LIMIT = 0.75
# By the effort of a change.
KINDS = (
    "dead band",
    "no integral action",
    "dead band and reset",
    "dead band, reset and limit",
)
# Without integral action, it only holds a known load.
HOLDING = IntegralRule(resets=True)
# Part of the other axes that may hunt.
FEW = 0.05


class Cure(NamedTuple):
    """A change that ends the hunting: gains, and what the integral does.

    The axis then rests within ``error`` [rad] of the reference, after ``seconds`` at most.
    """

    name: str
    controller: Controller
    rule: IntegralRule
    error: float
    seconds: float


def cures(
    axis: Axis,
    controller: Controller,
    *,
    counts: int,
    sample_time: float,
    delay: float,
    tolerance: float = inf,
    others: Sequence[Axis] = (),
    progress: Progress = unseen,
) -> tuple[Cure, ...]:
    """What ends the hunting within a ``tolerance`` [rad], by the error that remains.

    With a finite tolerance the dead bands are the largest that it allows, which rest soonest,
    otherwise the smallest that end the hunting. Nearly all ``others``, such as what a recording
    leaves open, must rest as well.
    """

    def seconds(true: Axis, gains: Controller, rule: IntegralRule, late: float = 0.0) -> float:
        loop = {"sample_time": sample_time, "delay": delay + late}
        return rests_after(true, gains, rule, counts=counts, **loop)

    def longest(gains: Controller, rule: IntegralRule) -> float:
        """The longest time [s] until the axis rests, and nearly all others; infinite otherwise."""
        found = seconds(axis, gains, rule, sample_time)
        for level in LEVELS:
            found = max(
                found, inf if found == inf else seconds(with_level(axis, level), gains, rule)
            )
        hunting = 0
        for other in others if found < inf else ():
            after = seconds(other, gains, rule)
            hunting += after == inf
            if hunting > FEW * len(others):
                return inf
            found = max(found, after if after < inf else 0.0)
        return found

    friction, count = axis.friction, 2.0 * pi / counts if counts else 0.0
    held = LEVELS[-1] * highest_level(friction) / max(controller.stiffness, 1e-300)
    bands = _bands(count, 1.5 * count or SMALLEST * held, held, tolerance)
    moving = LIMIT * friction.alpha0 * (1.0 - abs(friction.asymmetry))
    more: dict[str, tuple[Any, ...]] = {
        "dead band": (),
        "dead band and reset": (True,),
        "dead band, reset and limit": (True, moving),
    }
    found: list[Cure] = []
    for name in progress(KINDS, len(KINDS)):
        if name in more:
            # A limit is of use only below the dead band that a reset needs without it.
            below = min(
                (c.error for c in found if name == KINDS[-1] and c.rule.resets), default=inf
            )
            rules = [IntegralRule(band, *more[name]) for band in bands if band < below]
            rule, after = _first(rules, lambda rule: longest(controller, rule))
            cure = Cure(name, controller, rule, rule.dead_band, after)
        else:
            gains = without_integral(controller)
            cure = Cure(name, gains, HOLDING, held + 0.5 * count, longest(gains, HOLDING))
        if cure.seconds < inf and cure.error <= tolerance:
            found.append(cure)
    return tuple(sorted(found, key=lambda cure: cure.error))


def simplest(found: Iterable[Cure], count: float, tolerance: float = inf) -> Cure:
    """The simplest within a tolerance, or of those whose error is nearly the smallest [rad]."""
    allowed = tolerance
    if allowed == inf:
        smallest = min(cure.error for cure in found)
        allowed = max(AS_GOOD * smallest, smallest + count)
    return min((c for c in found if c.error <= allowed), key=lambda cure: KINDS.index(cure.name))


def _first(
    rules: Sequence[IntegralRule], check: Callable[[IntegralRule], float]
) -> tuple[IntegralRule, float]:
    """The first rule that ends the hunting, as the one before it does, and the time; or inf.

    Next to a dead band that rests by chance there is one that does not.
    """
    before = inf
    for rule in rules:
        after = check(rule)
        if max(before, after) < inf:
            return rule, after
        before = after
    return NO_RULE, inf


def _bands(count: float, smallest: float, held: float, tolerance: float) -> list[float]:
    """Dead bands [rad], between whole counts of the encoder, in the order in which they are tried.

    Upwards from the smallest, or downwards from a tolerance.
    """
    largest = min(tolerance, max(held, STEP * smallest))
    steps = STEP ** np.arange(1.0 + max(log(largest / smallest) / log(STEP), 0.0))
    sizes = smallest * steps if tolerance == inf else largest / steps
    if count:
        sizes = np.array(list(dict.fromkeys(np.floor(sizes / count - 0.5)))) * count + 0.5 * count
    return [float(size) for size in sizes if size >= 0.99 * smallest]
