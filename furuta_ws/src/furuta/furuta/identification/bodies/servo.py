r"""A smart servo with a position loop of its own, of which only goal and position are logged.

.. math::
    J\ddot q = \mathrm{sat}_U(g(t - d) - q) - B\dot q - F\,\mathrm{sgn}\,\dot q - f_0

All in units of the loop's stiffness, which goal and position do not show: J [s²], B [s], and F, f_0
and the limit U by the supply [rad]. A goal that is nearer than F moves nothing: 2F is the dead band
of the servo.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from furuta.identification.averaging import explained_by, few, mixture_errors
from furuta.identification.axis.effects import AT_ONCE, EXCESSES, SURE
from furuta.identification.axis.motion import MOST_EVENTS, SHORTEST, AxisModel, next_slide
from furuta.identification.axis.segments import segmented, smoothed
from furuta.identification.axis.start import SLIDES
from furuta.identification.bodies.axis import NOTHING, model_of
from furuta.identification.bodies.body import Differentiated, Segments
from furuta.identification.fitted import Fitted, doubts_of, natural, reported, residual_of
from furuta.identification.least_squares import Fit, Problem, evaluated, fit, projection
from furuta.identification.unknowns import Key, Unknown, Unknowns, Values, name_of
from furuta.identification.verdict import DOUBTFUL, Verdict
from furuta_model.compiled import compiled
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording, findings_of

# Longest step of the integration [s]: within one the loop's pull is that of its middle.
STEP = 5e-4
# Delays [s] that the first estimate tries.
DELAYS = np.arange(0.0, 0.05, 0.002)
# Limits that are tried first, in the largest error of the loop.
LIMITS = np.geomspace(0.1, 1.0, 10)
# Starts that are fitted, and inertias [s²] that are tried first with the damping of a usual loop.
TRIED = 3
INERTIAS = np.geomspace(1e-4, 1e-2, 9)
# Stiction that is tried first, in the friction of a slide.
STICTION = (0.0, 0.5)
# Correlation of a goal with itself, some time later, from which it repeats, and below which it has
# changed before; and how often it then repeats at least.
REPEATS, CHANGED, OFTEN = 0.97, 0.5, 4
# Names in a report.
NAMES: dict[Key, str] = {"alpha0": "friction", ("offset", 0): "offset"}
# Units of what is no position, per stiffness of the loop.
UNITS = {"inertia": "s²", "viscous": "s", "delay": "s"}


class Servo(Differentiated):
    """Positions of a servo."""

    speed: int | None = 1

    def outputs(self, values: Values, first: np.ndarray, cut: Segments) -> np.ndarray:
        """Positions (n, 1)."""
        axis = model_of({key: value for key, value in values.items() if key != "limit"})
        data, out = cut.data, np.empty(len(cut.time))
        _move(axis, values["limit"], first, cut.time, cut.bounds, data.edges, data.torque, out)
        return out[:, None]


@compiled
def _move(
    m: AxisModel,
    limit: float,
    first: np.ndarray,
    time: np.ndarray,
    bounds: np.ndarray,
    edges: np.ndarray,
    goal: np.ndarray,
    out: np.ndarray,
) -> None:
    """Positions (n,) of all segments, each from its own first state (s, 2)."""
    last = len(edges) - 1
    for s in range(len(bounds) - 1):
        q, v, t = first[s, 0], first[s, 1], time[bounds[s]]
        k = max(np.searchsorted(edges, t - m.delay, side="right") - 1, 0)
        for i in range(bounds[s], bounds[s + 1]):
            while time[i] - t > SHORTEST:
                while k < last and edges[k + 1] + m.delay <= t + SHORTEST:
                    k += 1
                until = min(time[i], t + STEP)
                if k < last:
                    until = min(until, edges[k + 1] + m.delay)
                left = until - t
                pull = min(max(goal[k] - q - 0.5 * left * v, -limit), limit)
                for _ in range(MOST_EVENTS):
                    slide = next_slide(q, v, pull, m.offsets[0], t, left, m)
                    q += 0.0 if slide.sticks else slide.travel
                    v = 0.0 if slide.sticks or slide.stops else slide.after
                    left -= slide.time
                    if slide.sticks or not slide.stops or left <= SHORTEST:
                        break
                t = until
            out[i] = q


def identify_servo(recording: Recording) -> Fitted:
    """Fit a servo to a recording whose command is its goal [rad].

    Raises:
        ParameterError: The servo does not follow its goal.
    """
    ready = cleaned(recording, joints=(0,))
    values, error, fastest = _first_values(ready)
    cut = segmented([ready])
    problem = Problem(Servo(), cut, _unknowns(values, error, fastest))
    starts = sorted(_starts(values), key=lambda each: evaluated(problem, each, cut.first).cost)
    best = min((fit(problem, each) for each in starts[:TRIED]), key=lambda each: each.cost)
    unlimited = problem._replace(
        unknowns=Unknowns(each for each in problem.unknowns if each.key != "limit")
    )
    free = fit(unlimited, {**best.values, "limit": 2.0 * values["limit"]})
    if explained_by(free.cost, best.cost, free.inflation(SURE)) < np.log(len(LIMITS)):
        best = free
    return _result(cut, *_averaged(problem._replace(unknowns=best.unknowns), best), ready)


def _averaged(problem: Problem, best: Fit) -> tuple[Fit, np.ndarray]:
    """The fit with stiction if that is more probable, and the covariance (p, p) over any stiction.

    As friction that falls at once it moves in stairs: it is held, and all of a grid count by their
    evidence.
    """
    level = best.values["alpha0"]
    tried: list[Values] = [{**best.values, "alpha1": part * level} for part in (0.0, *EXCESSES)]
    gains, steps = _gained(problem, best, tried)
    if np.max(gains) > np.log(len(EXCESSES)):
        other = fit(problem, tried[int(np.argmax(gains))], best.state.first)
        best = min(best, other, key=lambda each: each.cost)
        gains, steps = _gained(problem, best, tried)
    parts = np.append(1.0, np.full(len(EXCESSES), 1.0 / len(EXCESSES)))
    weights = parts * np.exp(gains - np.max(gains))
    own = np.diag(best.covariance) * few(best.segments - len(best.unknowns))
    errors = mixture_errors(weights / weights.sum(), steps, np.tile(own, (len(steps), 1)))
    factor = errors / np.sqrt(np.diag(best.covariance))
    return best, best.covariance * np.outer(factor, factor)


def _gained(problem: Problem, best: Fit, tried: list[Values]) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms of the evidence (n,) of values against a fit, and steps (n, p) to them."""
    project, inflation = projection(problem, best), best.inflation(SURE)
    least = float(project(best.values)[0].sum())
    near: list[Values] = [{**best.values, "alpha1": each["alpha1"]} for each in tried]
    squares, steps = zip(*(project(each) for each in near), strict=True)
    gains = [explained_by(least, float(each.sum()), inflation) for each in squares]
    return np.array(gains), np.array(steps)


def _starts(values: Values) -> Iterator[Values]:
    """First values to compare: a limit that is too large has no slope.

    A loop that is faster than the samples hides its inertia from the regression.
    """
    damped: list[Values] = [{"inertia": each, "viscous": 1.4 * np.sqrt(each)} for each in INERTIAS]
    for body, part, excess in itertools.product((values, *damped), LIMITS, STICTION):
        more: Values = {"limit": part * values["limit"], "alpha1": excess * values["alpha0"]}
        yield {**values, **body, **more}


def _result(cut: Segments, best: Fit, covered: np.ndarray, recording: Recording) -> Fitted:
    """What is determined, and the verdict."""
    report = reported(best, covered, {}, NAMES)
    if "limit" not in best.unknowns.keys:
        late = recording.commanded_at(recording.time) - recording.measured[:, PHI]
        largest = float(np.max(np.abs(late)))
        report.undetermined["limit"] = f"the loop does not reach it: at least {largest:.3g}"
    residual = residual_of(best, cut, cut.noise)
    return Fitted(
        *report,
        {name: UNITS.get(name, recording.units[0]) for name in report.values},
        Verdict.of([*doubts_of(best, residual, report, needed=False), *_repeated(recording)]),
        findings_of([recording]),
        tuple(NAMES.get(key, name_of(key)) for key in best.unknowns.keys),
        natural(best, covered),
        residual,
        (recording,),
        best,
        Servo(),
    )


def _repeated(recording: Recording) -> Iterator[tuple[str, str]]:
    """A doubt about a goal that repeats: so do the errors of the model, and segments are alike."""
    even = np.arange(recording.time[0], recording.time[-1], recording.interval)
    goal = recording.commanded_at(even)
    goal = goal - np.mean(goal)
    later = np.arange(1, len(goal) // OFTEN)
    size = np.append(0.0, np.cumsum(goal**2))
    together = np.correlate(goal, goal, "full")[len(goal) :][: len(later)]
    alike = together / np.sqrt(size[len(goal) - later] * (size[-1] - size[later]) + 1e-300)
    changed = np.maximum.accumulate(alike < CHANGED)
    again = np.flatnonzero(changed & (alike > REPEATS))
    if len(again):
        first = again[0]
        period = later[first + np.argmax(alike[first : 2 * first])] * recording.interval
        yield (
            DOUBTFUL,
            f"the goal repeats every {period:.2g} s: record moves of different lengths and speeds",
        )


def _unknowns(values: Values, error: float, fastest: float) -> Unknowns:
    """What is fitted; sizes are the usual error of the loop [rad] and a fast speed."""
    return Unknowns(
        (
            Unknown("inertia", size=values["inertia"], factor=2.5),
            Unknown("alpha0", low=0.0, size=error),
            Unknown("viscous", low=0.0, size=error / fastest),
            Unknown("delay", low=0.0, size=0.002, step=0.02),
            Unknown("limit", size=10.0 * error, factor=2.5),
            Unknown(("offset", 0), size=error),
        )
    )


def _first_values(recording: Recording) -> tuple[Values, float, float]:
    """By regression of the loop's error where the servo slides; and its usual error and speed."""
    even = smoothed(recording)
    error = even.torque - even.position
    fastest, size = float(np.max(np.abs(even.speed))), float(np.sqrt(np.mean(error**2)))
    slides = np.abs(even.speed) > SLIDES * fastest
    found = []
    for delay in DELAYS:
        late = np.interp(even.time - delay, even.time, even.torque) - even.position
        free = slides & (np.abs(late) < np.quantile(np.abs(late), 0.8))
        columns = (even.acceleration, np.sign(even.speed), even.speed, np.ones(len(error)))
        matrix = np.column_stack(columns)[free]
        x, *_ = np.linalg.lstsq(matrix, late[free], rcond=None)
        found.append((float(np.mean((late[free] - matrix @ x) ** 2)), delay, x))
    left, delay, (inertia, level, viscous, offset) = min(found, key=lambda each: each[0])
    if not np.sqrt(left) < 0.5 * size:
        raise ParameterError(
            f"{recording.name}: the servo does not follow its goal; check unit and sign of the goal"
        )
    values = {
        **NOTHING,
        "inertia": max(float(inertia), 1e-6),
        "alpha0": max(float(level), 0.01 * size),
        "viscous": max(float(viscous), 0.0),
        "delay": float(delay),
        "stribeck_velocity": AT_ONCE * fastest,
        "limit": float(np.max(np.abs(error))),
        ("offset", 0): float(offset),
    }
    return values, size, fastest
