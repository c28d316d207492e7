"""Finds and classifies the final motion of the ideal loop.

The loop is followed from its initial state until the motion nearly repeats; from there Newton's
method converges to the limit cycle. Without reversals the arm is at rest or rotates.
"""

from __future__ import annotations

import numpy as np

from furuta_analysis.limit_cycles.exact_motion import (
    EVENT,
    PHI_HIGH,
    PHI_LOW,
    TOO_STIFF,
    UNBOUNDED,
)
from furuta_analysis.limit_cycles.ideal_loop import IdealLoop, next_mode, rate
from furuta_analysis.limit_cycles.periodic_orbit import REST, LimitCycle, periodic_orbit
from furuta_analysis.limit_cycles.section import LONGEST_RETURN, Section
from furuta_model.friction.lugre import highest_level
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI_DOT, PLANT_STATES, THETA, THETA_DOT

RETURNS = 60  # after which the motion is classified as irregular
MAX_TURNS = 4  # largest number of upper reversals per period
NEARBY = 0.05  # relative change of the section point below which Newton's method is started
STEADY = 0.01  # relative change of speed over the longest return of a steady rotation
FRICTIONLESS = 1e-9  # [V]
STILL = 1e-6  # largest speed [rad/s] and angle [rad] at rest


def limit_cycle(loop: IdealLoop, start: np.ndarray | None = None) -> LimitCycle:
    """The final motion of the loop from state ``start`` (5,), by default at rest at 0.05 rad."""
    _check(loop)
    if highest_level(loop.law.parameters) < FRICTIONLESS:
        # Without friction there is no bristle to follow.
        loop = loop._replace(law=loop.law.named("coulomb"))
    section = Section(loop)
    y = state_at_rest(0.05) if start is None else np.array(start, dtype=float)
    points: list[np.ndarray] = []
    largest = 0.0
    mode: float | None = _first_mode(y, loop)
    for _ in range(RETURNS):
        end = section.follow(y, mode)
        mode = None
        y = end.y
        if end.ended == UNBOUNDED:
            return LimitCycle("unbounded")
        if end.ended == TOO_STIFF:
            raise ParameterError(
                "the bristle is too fast to follow: sigma0 is too large or the friction level "
                "too small; a stick-slip law (coulomb, stiction, stribeck) has no bristle"
            )
        if end.ended != EVENT:
            return _motion_without_reversals(loop, y)
        size = float(end.extent[PHI_HIGH] - end.extent[PHI_LOW])
        if size < REST:
            return LimitCycle("rest")
        points.append(y[section.free])
        largest = max(largest, size)
        for turns in _recurrences(points):
            cycle = periodic_orbit(section, points[-1], turns, largest)
            # The motion ends in a stable cycle. Newton's method may find an unstable one nearby.
            if cycle is not None and cycle.stable:
                return cycle
    return LimitCycle("irregular", phi_peak_to_peak_rad=largest)


def state_at_rest(theta: float) -> np.ndarray:
    """State (5,) at rest with the pendulum at ``theta`` [rad]."""
    y = np.zeros(PLANT_STATES)
    y[THETA] = theta
    return y


def _recurrences(points: list[np.ndarray]) -> list[int]:
    """Numbers of reversals after which the motion nearly repeats; empty if it does not yet."""
    near = NEARBY * np.linalg.norm(points[-1])
    return [
        turns
        for turns in range(1, min(MAX_TURNS, len(points) - 1) + 1)
        if np.linalg.norm(points[-1] - points[-1 - turns]) < near
    ]


def _motion_without_reversals(loop: IdealLoop, y: np.ndarray) -> LimitCycle:
    """Rest, steady rotation, or a speed that still grows.

    The arm may rest away from zero, where friction balances l₁φ.
    """
    v = float(y[PHI_DOT])
    if max(abs(v), abs(y[THETA]), abs(y[THETA_DOT])) < STILL:
        return LimitCycle("rest", point=tuple(y))
    dy = np.empty(PLANT_STATES)
    rate(y, float(np.sign(v)), loop, dy)
    gain = dy[PHI_DOT] * LONGEST_RETURN / v
    if gain > STEADY:
        return LimitCycle("unbounded")
    if gain < -STEADY:  # the arm creeps towards the angle where friction balances l₁φ
        return LimitCycle("rest", point=tuple(y))
    return LimitCycle("rotation", rotation_rate_rad_s=v)


def _first_mode(y: np.ndarray, loop: IdealLoop) -> float:
    """Mode of the first piece of motion from state ``y``."""
    if y[PHI_DOT] != 0.0:
        return float(np.sign(y[PHI_DOT]))
    if not loop.law.bristle:
        return next_mode(y, 1.0, loop)
    dy = np.empty(PLANT_STATES)
    rate(y, 1.0, loop, dy)
    return 1.0 if dy[PHI_DOT] >= 0.0 else -1.0


def _check(loop: IdealLoop) -> None:
    loop.body.check()
    gains = (loop.l1, loop.l2, loop.l3, loop.l4)
    if not np.all(np.isfinite(gains)):
        raise ParameterError(f"feedback must be finite, given {gains}")
