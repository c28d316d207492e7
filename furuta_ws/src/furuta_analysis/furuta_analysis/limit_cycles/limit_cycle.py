"""Periodic motions of the ideal loop as fixed points of a Poincaré map.

The section is the arm's turn from forward motion, v = 0 from above. There the state has n free
coordinates: φ, θ, θ̇ and, under LuGre, the bristle z; φ drops out when it is not fed back, for then
nothing depends on it. The map P takes one turn to the next. A periodic motion is s = P(s), found
by Newton's method from wherever a few returns have led, stable or not; its Floquet multipliers are
the eigenvalues of dP/ds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_analysis.limit_cycles.exact_motion import (
    PHI_HIGH,
    PHI_LOW,
    STUCK,
    THETA_HIGH,
    THETA_LOW,
    TOO_STIFF,
    TURNED,
    UNBOUNDED,
    to_upper_turn,
)
from furuta_analysis.limit_cycles.ideal_loop import (
    IdealLoop,
    feedback,
    friction_at,
    next_mode,
    rate,
)
from furuta_model.friction.lugre import highest_level
from furuta_model.parameters import ParameterError
from furuta_model.state import BRISTLE, PHI, PHI_DOT, PLANT_STATES, THETA, THETA_DOT

MOST_STEPS = 200_000
NO_TRACE = np.empty((0, PLANT_STATES + 1))
LONGEST_RETURN = 300.0  # [s] without a turn: the arm rotates
RETURNS = 60  # followed before the motion is called irregular
LONGEST_CYCLE = 4  # turns per period that are looked for
NEARBY = 0.05  # relative change of the section point from which Newton is tried
STEADY = 0.01  # relative change of speed over the longest return that is still steady
FRICTIONLESS = 1e-9  # [V]
STILL = 1e-6  # speed [rad/s] and angle [rad] of what stands still
REST = 1e-7  # [rad] peak to peak of what counts as rest
SMALL_STEP = 1e-6  # of the finite differences, relative to the cycle's size
ROUNDING = 1e-9  # of a Newton correction that ends the iteration, relative likewise
NEWTON_STEPS = 25


class LimitCycle(NamedTuple):
    """The motion a loop ends in (``kind``: oscillation, rotation, rest, unbounded, irregular)."""

    kind: str
    phi_peak_to_peak_rad: float = 0.0
    theta_peak_to_peak_rad: float = 0.0
    period_s: float = float("nan")
    rotation_rate_rad_s: float = 0.0
    stuck_fraction: float = 0.0
    floquet_multipliers: tuple[complex, ...] = ()
    turns: int = 1  # of the arm per period
    point: tuple[float, ...] = ()  # state (5,) at the turn

    @property
    def stable(self) -> bool:
        """Whether all Floquet multipliers are inside the unit circle."""
        return self.kind in ("rest", "rotation") or (
            self.kind == "oscillation" and all(abs(m) < 1.0 for m in self.floquet_multipliers)
        )


class Return(NamedTuple):
    """One application of the map: end state (5,), time [s], extent (5,), how it ended."""

    y: np.ndarray
    time: float
    extent: np.ndarray
    ended: int


class Section:
    """The Poincaré map of a loop in its free coordinates."""

    def __init__(self, loop: IdealLoop) -> None:
        self.loop = loop
        free = [PHI] if loop.l1 != 0.0 else []
        free += [THETA, THETA_DOT]
        self.free = [*free, BRISTLE] if loop.law.bristle else free

    def state(self, s: np.ndarray) -> np.ndarray:
        """State (5,) of section coordinates."""
        y = np.zeros(PLANT_STATES)
        y[self.free] = s
        return y

    def follow(self, y: np.ndarray, mode: float | None = None, turns: int = 1) -> Return:
        """Go to the ``turns``-th next upper turn; ``mode`` None starts from such a turn."""
        y = y.copy()
        extent = np.array([y[PHI], y[PHI], y[THETA], y[THETA], 0.0])
        time = 0.0
        for _ in range(turns):
            start = next_mode(y, 1.0, self.loop) if mode is None else mode
            mode = None
            ended, took, _ = to_upper_turn(y, start, LONGEST_RETURN, self.loop, extent, NO_TRACE)
            time += took
            if ended != TURNED:
                return Return(y, time, extent, ended)
        return Return(y, time, extent, TURNED)

    def map(self, s: np.ndarray, turns: int) -> np.ndarray | None:
        """P(s), or None where the motion does not return."""
        end = self.follow(self.state(s), turns=turns)
        return end.y[self.free] if end.ended == TURNED else None

    def jacobian(self, s: np.ndarray, turns: int, size: float) -> np.ndarray | None:
        """dP/ds by central differences."""
        columns = []
        for i in range(len(s)):
            # The bristle's deflection is small by nature, σ₀ times smaller than a torque.
            scale = size / self.loop.law.parameters.sigma0 if self.free[i] == BRISTLE else size
            d = np.zeros_like(s)
            d[i] = SMALL_STEP * scale
            ahead, behind = self.map(s + d, turns), self.map(s - d, turns)
            if ahead is None or behind is None:
                return None
            columns.append((ahead - behind) / (2 * d[i]))
        return np.array(columns).T


def limit_cycle(loop: IdealLoop, start: np.ndarray | None = None) -> LimitCycle:
    """The motion that the loop ends in, released at ``start`` (5,), 0.05 rad off upright."""
    _check(loop)
    if highest_level(loop.law.parameters) < FRICTIONLESS:
        # Without friction there is no bristle to follow.
        loop = loop._replace(law=loop.law.named("coulomb"))
    section = Section(loop)
    y = released(0.05) if start is None else np.array(start, dtype=float)
    points: list[np.ndarray] = []
    largest = 0.0
    mode: float | None = _first_mode(y, loop)
    for _ in range(RETURNS):
        passed = section.follow(y, mode)
        mode = None
        y = passed.y
        if passed.ended == UNBOUNDED:
            return LimitCycle("unbounded")
        if passed.ended == TOO_STIFF:
            raise ParameterError(
                "the bristle is too fast to follow: sigma0 is too large or the friction level "
                "too small; a stick-slip law (coulomb, stiction, stribeck) has no bristle"
            )
        if passed.ended != TURNED:
            return _without_turns(loop, y)
        size = float(passed.extent[PHI_HIGH] - passed.extent[PHI_LOW])
        if size < REST:
            return LimitCycle("rest")
        points.append(y[section.free])
        largest = max(largest, size)
        for turns in _recurrences(points):
            found = periodic_orbit(section, points[-1], turns, largest)
            # The motion ends in a stable cycle; one that Newton finds beside it may not be.
            if found is not None and found.stable:
                return found
    return LimitCycle("irregular", phi_peak_to_peak_rad=largest)


def released(theta: float) -> np.ndarray:
    """State (5,) at rest with the pendulum at ``theta`` [rad]."""
    y = np.zeros(PLANT_STATES)
    y[THETA] = theta
    return y


def periodic_orbit(
    section: Section, guess: np.ndarray, turns: int = 1, size: float = 0.1
) -> LimitCycle | None:
    """The periodic motion near ``guess`` (section coordinates), stable or not; None if none."""
    s = guess.copy()
    identity = np.eye(len(s))
    for _ in range(NEWTON_STEPS):
        end = section.map(s, turns)
        if end is None:
            return None
        jacobian = section.jacobian(s, turns, size)
        if jacobian is None:
            return None
        try:
            correction = np.linalg.solve(identity - jacobian, end - s)
        except np.linalg.LinAlgError:
            return None
        s = s + correction
        if np.linalg.norm(correction) < ROUNDING * size:
            return _described(section, s, turns, size)
        if np.linalg.norm(correction) > 10.0 * max(size, float(np.linalg.norm(guess))):
            return None
    return None


class Trajectory(NamedTuple):
    """One period of a cycle: time (n,) [s], state (n, 5), control and friction (n,) [V]."""

    time: np.ndarray
    state: np.ndarray
    control: np.ndarray
    friction: np.ndarray


def trace(loop: IdealLoop, cycle: LimitCycle) -> Trajectory:
    """The motion of an oscillation over one period, at the steps of its integration."""
    y = np.array(cycle.point)
    rows = [np.append(0.0, y)]
    extent, room = np.zeros(5), np.empty((MOST_STEPS, PLANT_STATES + 1))
    elapsed = 0.0
    for _ in range(cycle.turns):
        mode = next_mode(y, 1.0, loop)
        _, took, n = to_upper_turn(y, mode, LONGEST_RETURN, loop, extent, room)
        part = room[:n].copy()
        part[:, 0] += elapsed
        rows.extend(part)
        elapsed += took
    table = np.array(rows)
    state = table[:, 1:]
    return Trajectory(
        table[:, 0],
        state,
        np.array([feedback(x, loop) for x in state]),
        np.array([friction_at(x, loop) for x in state]),
    )


def _described(section: Section, s: np.ndarray, turns: int, size: float) -> LimitCycle | None:
    """All that is said of the periodic motion through ``s``."""
    end = section.follow(section.state(s), turns=turns)
    jacobian = section.jacobian(s, turns, size)
    phi = float(end.extent[PHI_HIGH] - end.extent[PHI_LOW])
    if jacobian is None or phi < REST:
        return None
    return LimitCycle(
        "oscillation",
        phi,
        float(end.extent[THETA_HIGH] - end.extent[THETA_LOW]),
        end.time,
        float(end.y[PHI] - section.state(s)[PHI]) / end.time,
        float(end.extent[STUCK]) / end.time,
        tuple(complex(m) for m in sorted(np.linalg.eigvals(jacobian), key=abs, reverse=True)),
        turns,
        tuple(section.state(s)),
    )


def _recurrences(points: list[np.ndarray]) -> list[int]:
    """After how many turns the motion nearly repeats, if it does yet."""
    near = NEARBY * np.linalg.norm(points[-1])
    return [
        turns
        for turns in range(1, min(LONGEST_CYCLE, len(points) - 1) + 1)
        if np.linalg.norm(points[-1] - points[-1 - turns]) < near
    ]


def _without_turns(loop: IdealLoop, y: np.ndarray) -> LimitCycle:
    """The arm no longer turns back: rest, steady rotation, or a speed that still grows.

    At rest the arm may stand off zero, where friction balances l₁φ.
    """
    v = float(y[PHI_DOT])
    if max(abs(v), abs(y[THETA]), abs(y[THETA_DOT])) < STILL:
        return LimitCycle("rest", point=tuple(y))
    dy = np.empty(PLANT_STATES)
    rate(y, float(np.sign(v)), loop, dy)
    gain = dy[PHI_DOT] * LONGEST_RETURN / v
    if gain > STEADY:
        return LimitCycle("unbounded")
    if gain < -STEADY:  # it creeps towards the place where friction balances l₁φ
        return LimitCycle("rest", point=tuple(y))
    return LimitCycle("rotation", rotation_rate_rad_s=v)


def _first_mode(y: np.ndarray, loop: IdealLoop) -> float:
    """The piece of motion that begins when the state is let go."""
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
