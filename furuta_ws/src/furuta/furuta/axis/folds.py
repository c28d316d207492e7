"""Folds of the limit cycle of an axis: the gain beyond which it does not hunt, curves, atlas."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from furuta.axis.axis import Axis, Controller, Pid, released, servo_cycle, servo_joint
from furuta.limit_cycles.joint import JointCycle, branch, joint_cycle
from furuta_model.friction.parameters import Friction

CLOSE = 0.01  # half of the range of the second search, relative to the fold of the first
STARTS = 9  # values at which a cycle is looked for

# An axis without units: inertia 1, Coulomb level 1, k_p = 4. Its Stribeck curve falls steeply, and
# the bristle is stiff enough to hunt.
EXAMPLE = Axis(1.0, Friction(1000.0, 30.0, 1.0, 0.5, stribeck_velocity=0.1))
GAINS = Pid(4.0, 1.5, 0.5)
# The atlas: k_d, range of static over Coulomb friction, least k_i relative to the largest, and from
# how many values of k_i below the first at which the axis hunts the fold is looked for.
ATLAS_DAMPING, RATIOS, LEAST_INTEGRAL, BELOW = 1.0, (1.1, 2.5), 0.02, 2


LoopAt = Callable[[float], tuple[Axis, Controller]]


class Fold(NamedTuple):
    """Where a stable and an unstable cycle meet: value of the parameter, and peak to peak."""

    value: float
    peak_to_peak: float


def hunting_cycle(axis: Axis, controller: Controller) -> JointCycle:
    """The final motion from a state in which the axis would hunt with stiction, which it may not.

    From elsewhere an axis that can hunt may come to rest.
    """
    start = servo_cycle(axis._replace(law="stiction"), controller).start
    given = servo_joint(axis, controller)
    return joint_cycle(given, np.array(start or released(axis, controller, len(given.loop.b))))


def fold(loop_at: LoopAt, low: float, high: float) -> Fold | None:
    """The fold of the cycles over a parameter between ``low`` and ``high``; None if there is none.

    It is the vertex of a parabola through three cycles of a branch, first of the whole range, then
    of one close to the fold.
    """
    for value in np.linspace(low, high, STARTS).tolist():
        cycle = hunting_cycle(*loop_at(value))
        if cycle.kind == "limit_cycle":
            break
    else:
        return None
    found = None
    for _ in range(2):
        start = np.array(cycle.start)
        points = branch(lambda at: servo_joint(*loop_at(at)), low, high, value, start)
        folds = [i for i, (_, _, event) in enumerate(points) if event == "fold"]
        if not folds:
            return found
        three = points[folds[0] - 1 : folds[0] + 2]
        found = _vertex(three)
        low, high = found.value * (1.0 - CLOSE), found.value * (1.0 + CLOSE)
        stable = [(v, cycle) for v, cycle, _ in three if cycle.stable and low < v < high]
        if not stable:
            return found
        value, cycle = stable[0]
    return found


def _vertex(three: list[tuple[float, JointCycle, str]]) -> Fold:
    sizes = np.array([cycle.peak_to_peak for _, cycle, _ in three])
    a, b, c = np.polyfit(sizes, [value for value, _, _ in three], 2)
    return Fold(float(c - b * b / (4.0 * a)), float(-b / (2.0 * a)))


class Atlas(NamedTuple):
    """Peak to peak (n, m) of the cycle over k_i (n,) and static over Coulomb friction (m,).

    NaN where the axis comes to rest. ``folds`` (m,) are the values of k_i at the fold.
    """

    integral: np.ndarray
    ratio: np.ndarray
    peak_to_peak: np.ndarray
    folds: np.ndarray


def atlas(points: int = 16) -> Atlas:
    """The atlas of the example, up to the k_i at which it is unstable without friction."""
    ratio = np.linspace(*RATIOS, points)
    limit = GAINS.kp * ATLAS_DAMPING / EXAMPLE.inertia
    integral = np.linspace(LEAST_INTEGRAL, 1.0, points) * limit
    sizes, folds = np.full((points, points), np.nan), np.full(points, np.nan)
    for column, static in enumerate(ratio.tolist()):
        for row, ki in enumerate(integral.tolist()):
            cycle = hunting_cycle(*_atlas_loop(static, ki))
            if cycle.kind == "limit_cycle":
                sizes[row, column] = cycle.peak_to_peak
        hunts = np.flatnonzero(np.isfinite(sizes[:, column]))
        if len(hunts) and 0 < hunts[0] < points - 1:
            ends = integral[max(hunts[0] - BELOW, 0)], integral[hunts[0] + 1]
            found = fold(partial(_atlas_loop, static), *ends)
            folds[column] = found.value if found else np.nan
    return Atlas(integral, ratio, sizes, folds)


def _atlas_loop(ratio: float, ki: float) -> tuple[Axis, Pid]:
    friction = EXAMPLE.friction._replace(alpha1=(ratio - 1.0) * EXAMPLE.friction.alpha0)
    return EXAMPLE._replace(friction=friction), GAINS._replace(ki=ki, kd=ATLAS_DAMPING)
