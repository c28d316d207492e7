"""Finds and classifies the final motion of a loop with friction.

The loop is followed from its initial state until the motion nearly repeats; from there Newton's
method converges to the limit cycle. Without reversals the arm is at rest or rotates. The stability
of both is computed. An unstable one is left along the direction in which disturbances grow, and the
search goes on.
"""

import numpy as np

from furuta.describing_functions.steady_rotation import rotation_growth
from furuta.limit_cycles.exact_motion import MOST_REVERSALS
from furuta.limit_cycles.friction_loop import (
    FrictionLoop,
    first_mode,
    next_mode,
    rate,
    rest_distance,
)
from furuta.limit_cycles.linear_loop import LinearLoop
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import (
    REST,
    LimitCycle,
    Return,
    Section,
    limit_cycle_through,
    periodic_orbit,
)
from furuta.limit_cycles.rest_stability import rest_stability, rest_state
from furuta.limit_cycles.slip_cycle import slip_cycle
from furuta.limit_cycles.smooth_motion import (
    AT_REST,
    EVENT,
    FURTHER,
    HIGH,
    LOW,
    MAX_STEPS,
    OTHER_SIDE,
    STEPS,
    STUCK,
    TIME_OUT,
    TOO_STIFF,
    UNBOUNDED,
)
from furuta.oscillation import FRICTIONLESS
from furuta_model.friction.lugre import highest_level
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, PLANT_STATES, THETA, THETA_DOT

RETURNS = 3000  # after which, or after a long time, the motion is classified as irregular
MOTION_RETURNS = 10  # times the longest return
MIN_RETURNS = 60  # followed however long they take
SLIDES = 3  # long slides of a linear loop after which it is taken to slide for ever
WINDOWS = 20  # times without a reversal that the motion is followed on
NEARBY = 0.05  # relative change of the section point below which Newton's method is started
FEW_TURNS = 4  # reversals after which a motion comes near itself hardly by chance
VERY_NEARBY = 2e-3  # part of NEARBY, after more reversals
REPEATED = 1e-7  # relative change of the section point that is no change
SAME_SIZE = 1e-4  # such a change relative to the size of a cycle
SAME_POINT = 1e-6  # difference relative to it within which two points of a cycle are one
HELD = 1e-3  # largest distance from an equilibrium where a motion of size 0 is at rest
MUCH_CLOSER = 0.1  # ratio of such changes from which another period than the failed one is tried
STEADY = 0.01  # relative change of speed over the longest return of a steady rotation
STILL = 1e-6  # largest speed [rad/s] and angle [rad] of the pendulum in a steady rotation
DISTURBANCE = 1e-7  # [rad, rad/s] of an unstable rest or rotation
SAME_REST = 1e-5  # difference of the arm angle [rad] within which two rests are one
SLIDE = 0.5  # fraction of the peak-to-peak angle that is a slide, if no slide is longer


def limit_cycle(loop: FrictionLoop, start: np.ndarray | None = None) -> LimitCycle:
    """The final motion of the loop from state ``start``.

    By default the pendulum is released at rest at 0.05 rad.
    """
    loop.check()
    if highest_level(loop.law.parameters) < FRICTIONLESS:
        # Without friction there is no bristle to follow.
        loop = loop._replace(law=loop.law.named("coulomb"))
    y = state_at_rest(0.05) if start is None else np.array(start, dtype=float)
    return _Search(loop, y).run()


def state_at_rest(theta: float) -> np.ndarray:
    """State (5,) at rest with the pendulum at ``theta`` [rad]."""
    y = np.zeros(PLANT_STATES)
    y[THETA] = theta
    return y


class _Search:
    """Follows the loop from ``y``, return by return, until its final motion is known."""

    def __init__(self, loop: FrictionLoop, y: np.ndarray) -> None:
        self._loop, self._y = loop, y
        self._mode: float | None = first_mode(y, loop)
        self._section = Section(loop)
        self._points: list[np.ndarray] = []  # section points since the last disturbance
        self._seen: list[tuple[np.ndarray, Return]] = []  # start and end of each return
        self._largest = 0.0
        self._windows = 0
        self._failures = self._next_attempt = 0
        self._excursions: list[_Excursion] = []

    def run(self) -> LimitCycle:
        time = 0.0
        for number in range(RETURNS):
            end = self._follow()
            motion = self._after(end, number)
            if motion is not None:
                return motion
            time += end.time
            if number >= MIN_RETURNS and time > MOTION_RETURNS * self._loop.longest_return:
                break
        return self._irregular()

    def _irregular(self) -> LimitCycle:
        """What was seen in the last half of the returns; those before are the transient."""
        half = len(self._seen) // 2
        ends = [end for _, end in self._seen[half:]]
        start, observed = self._seen[half][0], sum(end.time for end in ends)
        low = np.min([end.extent[LOW] for end in ends], axis=0)
        sizes = np.max([end.extent[HIGH] for end in ends], axis=0) - low
        return LimitCycle(
            "irregular",
            float(sizes[PHI]),
            float(sizes[THETA]),
            rotation_rate_rad_s=float(ends[-1].y[PHI] - start[PHI]) / observed,
            stuck_fraction=float(sum(end.extent[FURTHER, STUCK] for end in ends)) / observed,
            turns=len(ends),
            point=tuple(start),
            smallest_slide=self._section.smallest,
            side=self._section.side,
            transient_s=sum(end.time for _, end in self._seen[:half]),
            observed_s=observed,
            loop=self._loop,
        )

    def _follow(self) -> Return:
        """Follow to the next return; from an unstable rest, to where a disturbance leads."""
        end = self._section.follow(self._y, self._mode)
        self._mode, self._start, self._y = None, self._y, end.y
        self._seen.append((self._start, end))
        return end

    def _after(self, end: Return, number: int) -> LimitCycle | None:
        """The final motion, if it is known after this return."""
        if end.ended == UNBOUNDED:
            return LimitCycle("unbounded", loop=self._loop)
        stiff = (
            number == 0 and end.ended != TIME_OUT and end.extent[FURTHER, STEPS] > 0.5 * MAX_STEPS
        )
        if stiff or end.ended == TOO_STIFF:  # soon, if a later slide may need too many steps
            raise ParameterError(
                "the bristle is too fast to follow: sigma0 is too large, or the friction level of "
                "a direction too small (asymmetry near 1); a stick-slip law (coulomb, stiction, "
                "stribeck) has no bristle"
            )
        if self._excursions:
            self._excursions[-1].include(end)
        size = _size(end)
        if end.ended == AT_REST or (end.ended == EVENT and size < REST and self._is_held()):
            return self._at_rest()
        if end.ended == OTHER_SIDE:
            self._section = Section(self._loop, self._section.smallest, -self._section.side)
            self._points = []
            return None
        if end.ended != EVENT:
            return self._without_return(end)
        self._points.append(end.y[self._section.free])
        self._largest = max(self._largest, size)
        return self._cycle(number) if number >= self._next_attempt else None

    def _is_held(self) -> bool:
        """Whether friction holds all of the loop at ``y``, not only the joint for an instant."""
        mode = self._section.side if self._loop.law.bristle else 0.0
        return bool(rest_distance(self._y, mode, self._loop) < HELD)

    def _cycle(self, number: int) -> LimitCycle | None:
        """The stable cycle near the last return, if the motion nearly repeats.

        After failures it is tried less and less often: the motion may pass slowly where a cycle has
        just disappeared.
        """
        failed = np.inf  # closeness of a recurrence from which Newton's method failed
        for turns, closeness in _recurrences(self._points):
            if closeness > MUCH_CLOSER * failed:
                continue  # a multiple of that period, which would fail too
            cycle = self._cycle_near_last(turns, closeness)
            # The motion ends in a stable cycle. Newton's method may find an unstable one nearby.
            if cycle is not None and cycle.stable:
                return cycle
            self._failures += 1
            self._next_attempt = number + 1 + self._failures // 3
            if cycle is None:
                failed = closeness
        return None

    def _cycle_near_last(self, turns: int, closeness: float) -> LimitCycle | None:
        point = self._points[-1]
        cycle = periodic_orbit(self._section, point, turns, self._largest)
        if cycle is not None:
            return self._with_smallest_period(cycle)
        if closeness < REPEATED:
            # Newton's method needs a smooth map; beside an unstable rest it may not be.
            cycle = limit_cycle_through(self._section, point, turns, self._largest)
            change = closeness * float(np.linalg.norm(point))
            if cycle is not None and change > SAME_SIZE * cycle.phi_peak_to_peak_rad:
                return None  # it dies out beside a state that does not
        return cycle

    def _with_smallest_period(self, cycle: LimitCycle) -> LimitCycle:
        """The same cycle over a part of the period, if it repeats within it.

        A motion that approaches a cycle from one side and the other in turn comes near itself after
        two periods first.
        """
        s = np.array(cycle.point)[self._section.free]
        for turns in range(1, cycle.turns // 2 + 1):
            if cycle.turns % turns == 0:
                end = self._section.map(s, turns)
                if end is not None and np.linalg.norm(end - s) < SAME_POINT * self._largest:
                    whole = periodic_orbit(self._section, s, turns, self._largest)
                    return whole or cycle
        return cycle

    def _without_return(self, end: Return) -> LimitCycle | None:
        """A steady rotation, or None: then the motion is followed on."""
        y, v = end.y, float(end.y[PHI_DOT])
        self._windows += 1
        self._mode = float(np.sign(v)) or next_mode(y, 1.0, self._loop)
        loop = self._loop
        if isinstance(loop, LinearLoop):
            if self._windows < SLIDES:
                return None
            return slip_cycle(loop, y) or self._irregular()
        slides = _size(end) <= abs(y[PHI] - self._start[PHI]) * (1.0 + 1e-9)
        if _is_steady(y, loop):
            return self._rotation(y, loop)
        if self._windows > WINDOWS:
            if slides and not loop.may_rotate:  # very slowly, to where friction holds it
                return self._at_rest()
            grows = slides and abs(v) > abs(self._start[PHI_DOT])
            unbounded = LimitCycle("unbounded", loop=loop)
            return unbounded if grows else self._irregular()
        if not slides and self._windows > 1:
            # The arm oscillates by less than what counted as a slide.
            self._section = Section(loop, SLIDE * _size(end), self._section.side)
            self._points = []
        return None

    def _rotation(self, y: np.ndarray, loop: IdealLoop) -> LimitCycle | None:
        v = float(y[PHI_DOT])
        growth = rotation_growth(v, loop.body, loop.gains, loop.law, loop.linear)
        if growth < 0.0 or self._windows > WINDOWS:
            return LimitCycle("steady", rotation_rate_rad_s=v, growth_rate_1_s=growth, loop=loop)
        self._y = y.copy()
        self._y[THETA] += DISTURBANCE
        return None

    def _at_rest(self) -> LimitCycle | None:
        """A stable rest, or None: then a disturbance leads away from it.

        If it leads back to an earlier rest, the motion repeats for ever, with pauses as long as a
        disturbance takes to grow.
        """
        y = rest_state(self._y, self._loop)
        growth, directions = rest_stability(y, self._loop)
        at_rest = LimitCycle("rest", point=tuple(y), growth_rate_1_s=growth, loop=self._loop)
        if growth < 0.0:
            return at_rest
        if growth > 0.0 and isinstance(self._loop, LinearLoop) and not self._loop.passes_rests:
            # It creeps past an unstable rest, unless it is as close as rounding.
            self._loop = self._loop._replace(passes_rests=True)
            self._section = Section(self._loop, self._section.smallest, self._section.side)
            self._mode = first_mode(self._y, self._loop)
            return None
        for number, excursion in enumerate(self._excursions):
            if abs(excursion.phi - y[PHI]) < SAME_REST:
                return _repeated(self._excursions[number:], growth, self._loop)
        for direction in directions:
            self._y = y + DISTURBANCE * direction
            self._mode = first_mode(self._y, self._loop)
            if _size(self._section.follow(self._y, self._mode)) > SAME_REST:
                self._excursions.append(_Excursion(self._y, float(y[PHI])))
                self._points = []
                return None
        return at_rest


class _Excursion:
    """Motion from one unstable rest, with the arm at ``phi`` [rad], to the next."""

    def __init__(self, start: np.ndarray, phi: float) -> None:
        self.start, self.phi = start, phi
        self.low, self.high = np.full(2, np.inf), np.full(2, -np.inf)

    def include(self, end: Return) -> None:
        """Extend the extremes of φ and θ by those of one return."""
        self.low = np.minimum(self.low, end.extent[LOW, [PHI, THETA]])
        self.high = np.maximum(self.high, end.extent[HIGH, [PHI, THETA]])


def _repeated(excursions: list[_Excursion], growth: float, loop: FrictionLoop) -> LimitCycle:
    low = np.min([excursion.low for excursion in excursions], axis=0)
    high = np.max([excursion.high for excursion in excursions], axis=0)
    phi, theta = (float(size) for size in high - low)
    return LimitCycle(
        "limit_cycle",
        phi,
        theta,
        float("inf"),
        stuck_fraction=1.0,
        point=tuple(excursions[0].start),
        rest_distance=0.0,
        growth_rate_1_s=growth,
        loop=loop,
    )


def _size(end: Return) -> float:
    return float(end.extent[HIGH, PHI] - end.extent[LOW, PHI])


def _recurrences(points: list[np.ndarray]) -> list[tuple[int, float]]:
    """Numbers of reversals after which the motion nearly repeats, and the relative change then."""
    size = float(np.linalg.norm(points[-1]))
    found = []
    for turns in range(1, min(MOST_REVERSALS, len(points) - 1) + 1):
        change = float(np.linalg.norm(points[-1] - points[-1 - turns]))
        near = NEARBY if turns <= FEW_TURNS else VERY_NEARBY * NEARBY
        if change < near * size:
            found.append((turns, change / size))
    return found


def _is_steady(y: np.ndarray, loop: IdealLoop) -> bool:
    """Whether the arm rotates at a speed that hardly changes, with the pendulum upright."""
    v = float(y[PHI_DOT])
    if loop.l1 != 0.0 or v == 0.0 or max(abs(y[THETA]), abs(y[THETA_DOT])) > STILL:
        return False
    dy = np.empty(PLANT_STATES)
    rate(y, float(np.sign(v)), loop, dy)
    return abs(float(dy[PHI_DOT]) * loop.longest_return / v) < STEADY
