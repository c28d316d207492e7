r"""Follows a stuck axis from slip to slip under a sampled controller, until it rests or hunts.

A stuck axis under integral action breaks away where the torque reaches the breakaway level. There

.. math:: v = 0, \qquad \text{torque} = ±(α_0 + α_1),

so the error alone is the state: every motion that has stuck once continues from one of these. They
are the starts, on a grid from a count to a release from far away. While the axis is stuck, its
torque changes by :math:`k_i e\,dt` a sample, so the wait until the next slip is a quotient and is
not simulated. An axis that is stuck for minutes beside its reference is thus not taken for one that
has settled.
"""

from __future__ import annotations

from math import inf

import numpy as np

from furuta.axis.axis import RELEASED_AT, Axis, Cascade, Controller, IntegralRule
from furuta.axis.servo import design_servo, integral_torque, observer_parameters, paper_units
from furuta.axis.simulation import LoopDesign, design_loop, measured_position, under_load
from furuta_model.compiled import compiled
from furuta_model.friction.laws import ZERO_SPEED, breakaway_level
from furuta_model.friction.lugre import highest_level
from furuta_model.integration import advance
from furuta_model.state import PHI, PHI_DOT, PLANT_STATES

# Errors from which an axis starts in either direction, and further ones relative to the dead band,
# where slips that end just beyond it make the smallest cycle. Substeps of a sample.
STARTS, BEYOND, SUBSTEPS = 10, (1.02, 1.08, 1.15, 1.25, 1.5), 20
# Most slips, samples of one slide, and seconds until an axis rests. What takes longer rests by
# chance, if at all.
SLIPS, SLIDE, LONGEST = 30, 200_000, 300.0
# Followed times are the longest of the grid's; between its starts an axis may take longer.
MARGIN = 1.25
# An error, relative to the largest start, from which an axis does not come back.
LOST = 5.0
# Time constant of the derivative in samples, and relative to k_d/k_p, if none is given.
FILTER_SAMPLES, FILTER_PART = 2.0, 0.1
# Speed times gain, relative to the breakaway level, from which the derivative counts as 0.
FADED = 1e-9


def rests_after(
    axis: Axis,
    controller: Controller,
    rule: IntegralRule,
    *,
    counts: int,
    sample_time: float,
    delay: float,
) -> float:
    """The longest time [s] until the axis rests from any start; infinite if it hunts from one.

    Its law must be one under which it truly sticks. The other arguments are those of
    :func:`furuta.axis.compensations.compare_on_axis`.
    """
    units = paper_units(axis, controller)
    count = 2.0 * np.pi / counts if counts else 0.0
    observer = observer_parameters(axis, units, "none", count, sample_time, delay)
    servo = design_servo(controller, observer, rule)
    loop = design_loop(axis, units, count, delay, False, servo)
    loop = loop._replace(substeps=max(loop.substeps, SUBSTEPS))
    share = sample_time / (sample_time + _filter_time(controller, sample_time))
    held = highest_level(axis.friction) / max(controller.stiffness, 1e-300)
    grid = np.geomspace(max(count, 1e-3 * held), RELEASED_AT * held, STARTS)
    grid = np.sort(np.append(grid, rule.dead_band * np.array(BEYOND)))[::-1]
    # Not on the grid of the encoder.
    sizes = grid + (0.37 + 0.1 * np.arange(len(grid))) % 1.0 * count
    return MARGIN * float(_longest(sizes, LOST * grid[0], share, loop))


def _filter_time(controller: Controller, sample_time: float) -> float:
    """Time constant [s] of the derivative, or of a measured speed."""
    if isinstance(controller, Cascade):
        usual = FILTER_PART / controller.position if controller.position else 0.0
    else:
        if controller.filter_time:
            return controller.filter_time
        usual = FILTER_PART * controller.kd / controller.kp if controller.kp else 0.0
    return max(FILTER_SAMPLES * sample_time, usual)


@compiled
def _longest(sizes: np.ndarray, lost: float, share: float, p: LoopDesign) -> float:
    """The longest time [s] until the axis rests, from errors in both directions."""
    longest = 0.0
    for size in sizes:
        for start in (size, -size):
            for breaks_away in (True, False):
                seconds = _rests_after(start, breaks_away, lost, share, p)
                if seconds == inf:
                    return inf
                longest = max(longest, seconds)
    return longest


@compiled
def _rests_after(
    start: float, breaks_away: bool, lost: float, share: float, p: LoopDesign
) -> float:
    """Time [s] until the axis rests; infinite if it does not.

    Args:
        start: Error [rad] at which it is stuck.
        breaks_away: Whether the integral is about to break it away; otherwise it is 0.
        lost: Error [rad] beyond which it does not come back.
        share: Of a new speed in the filtered one.
        p: The loop.
    """
    f, dt = p.servo.feedback, p.servo.dt
    x, torques = np.zeros(PLANT_STATES), np.zeros(p.delay + 1)
    x[PHI] = -start / p.position
    before, speed, last, seconds, integral = measured_position(-start, p), 0.0, 0.0, 0.0, 0.0
    unloaded = p.force / (1.0 - p.load_friction)
    forward = unloaded * breakaway_level(1.0, p.law)
    backward = unloaded * breakaway_level(-1.0, p.law)
    if breaks_away and f.integrates_error > 0.0:
        level = forward if start > 0.0 else -backward
        integral = level + f.error * before
        torques[:] = level
        if abs(before) > p.servo.rule.dead_band:  # at most since it slid the other way
            seconds = (forward + backward) / (f.integrates_error * abs(before))
    stuck = slid = slips = k = 0
    last_time = seconds + LONGEST
    while slips < SLIPS and slid < SLIDE and seconds < last_time:
        position = p.position * x[PHI]
        if not abs(position) < lost:
            break
        measured = measured_position(position, p)
        error, moved, previous = -measured, measured != before, integral
        speed += share * ((measured - before) / dt - speed)
        before = measured
        change = dt * (f.integrates_error * error + f.integrates_speed * speed)
        integral = integral_torque(integral, change, error, last, moved, 0.0, p.servo.rule)
        last = error if error != 0.0 else last
        newest = k % len(torques)
        torques[newest] = f.error * error + f.speed * speed + integral
        torque = torques[(k + 1) % len(torques)]  # the oldest
        k += 1
        seconds += dt
        holds = abs(x[PHI_DOT]) <= ZERO_SPEED and -backward <= torque <= forward
        if not holds:
            slips += 1 if stuck > 0 else 0
            stuck, slid = 0, slid + 1
            law = under_load(p.law, p.load_friction * abs(torque / p.force))
            advance(x, torque / p.force, p.dt, p.substeps, p.body, law)
            continue
        stuck, slid, rate = stuck + 1, 0, integral - previous
        if stuck <= len(torques) or abs(f.speed * speed) > FADED * forward:
            continue
        if rate == 0.0:
            return seconds
        # The torque changes evenly until it breaks the axis away.
        gap = forward - torques[newest] if rate > 0.0 else backward + torques[newest]
        wait = np.floor(gap / abs(rate)) - 1.0
        if wait > 0.0:
            integral += wait * rate
            torques += wait * rate
            seconds += wait * dt
    return inf
