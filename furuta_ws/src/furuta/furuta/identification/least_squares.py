"""Output error over segments, by Levenberg-Marquardt with the segments' first states eliminated.

Residuals count by their squares or, if a fit is robust, by 2(√(1 + r²) - 1). A robust fit weights
slopes and residuals alike, by (1 + r²)^-1/4: the quadratic function that this makes lies nowhere
below the loss, also far from its minimum.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from furuta.identification.bodies.body import Body, Segments
from furuta.identification.errors import at_least, inverse, jackknife
from furuta.identification.unknowns import Key, Unknowns, Values

MOST_ITERATIONS, MOST_TRIES = 40, 8
# First damping, factor by which it changes, and smallest damping.
DAMPING, FACTOR, SMALLEST = 1e-3, 5.0, 1e-9
# Decrease of the cost, in that of a sample, at which a fit ends, and one on the way.
FINE, COARSE = 0.05, 2.0
# Decrease, in the one that the linear problem promises, from which a step is taken as it is.
# Otherwise first states are solved for once more.
KEPT_PROMISE = 0.5
# Where a motion that leaves all bounds is held, in residuals that count as one.
FAR = 1e9
# Largest slope in a first state, in what counts as one per size: products of steeper ones would
# hide what is expected of the others. Unknowns may have any size, so theirs may be far steeper.
STEEP, STEEPEST = 1e6, 1e9
# Largest change of a first state in an iteration, in its standard deviations.
LARGEST = 2.0
# Most searches of first speeds, and relative gain from which the fit goes on after one.
SEARCHES, RESTART = 4, 1e-3
# Cost of a segment, in that of the median one, from which its first speed is searched.
BAD = 1.4
# Part of the segments that are a few.
FEW = 0.1
# Changes of a first speed that are tried, in its standard deviations, and how much smaller they are
# then about the best one: where an axis breaks away depends finely on it.
FINER = (1.0, 0.1, 0.01)
SEARCHED = (0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)


class Problem(NamedTuple):
    """What is fitted to what; ``robust`` limits the influence of large residuals."""

    body: Body
    cut: Segments
    unknowns: Unknowns
    robust: bool = False


class State(NamedTuple):
    """Where a fit is: values, first states (s, k), weighted residuals (n, c), and cost.

    ``costs`` (s,) are those of the segments with their first states. ``cost`` is their sum and that
    of the priors.
    """

    values: Values
    first: np.ndarray
    residuals: np.ndarray
    costs: np.ndarray
    cost: float


class Linearised(NamedTuple):
    """The problem about a state, in the unknowns' sizes, with first states eliminated.

    ``information`` (p, p) is the sum of the segments' ``blocks`` (s, p, p) and of ``prior`` (p,) on
    the diagonal, ``gradient`` (p,) that of their ``scores`` (s, p) and the priors'. First states
    follow a step by ``own - back @ step`` (s, k) and (s, k, p), in their spreads. ``columns``
    (n, c, p) and ``states`` (n, c, k) are weighted slopes, ``promise`` is the decrease of the cost
    by first states alone. ``scatter`` (p,) is the part of the priors in that of the gradient.
    """

    information: np.ndarray
    gradient: np.ndarray
    blocks: np.ndarray
    scores: np.ndarray
    back: np.ndarray
    own: np.ndarray
    columns: np.ndarray
    states: np.ndarray
    prior: np.ndarray
    scatter: np.ndarray
    promise: float

    def decrease(self, step: np.ndarray) -> float:
        """Decrease of the cost by a step (p,) that this linear problem promises."""
        return self.promise + float(2.0 * self.gradient @ step - step @ self.information @ step)

    def first(self, count: int) -> Linearised:
        """The problem of the first unknowns alone."""
        return self._replace(
            information=self.information[:count, :count],
            gradient=self.gradient[:count],
            blocks=self.blocks[:, :count, :count],
            scores=self.scores[:, :count],
            back=self.back[:, :, :count],
            columns=self.columns[:, :, :count],
            prior=self.prior[:count],
            scatter=self.scatter[:count],
        )


class Fit(NamedTuple):
    """A fit: what was fitted, where it ended, and what errors are computed from."""

    unknowns: Unknowns
    state: State
    about: Linearised

    @property
    def keys(self) -> tuple[Key, ...]:
        """The fitted unknowns."""
        return self.unknowns.keys

    @property
    def values(self) -> Values:
        """All values, fitted or not."""
        return self.state.values

    @property
    def cost(self) -> float:
        """That of residuals, first states and priors."""
        return self.state.cost

    @property
    def segments(self) -> int:
        """The number of segments."""
        return len(self.about.scores)

    @property
    def determined(self) -> float:
        """The number of unknowns that the data determine; of one that they hardly do, a part."""
        of_prior = np.diag(inverse(self.about.information, self.about.prior)) * self.about.prior
        return float(len(self.unknowns) - np.sum(np.clip(of_prior, 0.0, 1.0)))

    @property
    def rms(self) -> float:
        """Root mean square of the residuals of what was measured, in what counts as one."""
        r = self.state.residuals
        return float(np.sqrt(np.sum(r**2) / max(np.count_nonzero(r), 1)))

    @property
    def covariance(self) -> np.ndarray:
        """Covariance (p, p) of the unknowns in their sizes, by segments.

        In no direction is it smaller than that of white noise: few segments may inform of one.
        """
        return at_least(
            covariance(self.about), inverse(self.about.information, self.about.prior) * self.rms**2
        )

    def inflation(self, sure: Sequence[Key]) -> float:
        """Variance by segments over that of white noise.

        It is the median over unknowns of which every segment informs, at least that of white
        residuals, and at most that of residuals that last as long as a segment.
        """
        white = np.diag(inverse(self.about.information, self.about.prior))
        own = np.diag(self.covariance)
        kept = [k for k, key in enumerate(self.unknowns.keys) if key in sure]
        longest = len(self.about.columns) / self.segments
        return self.rms**2 * float(
            np.clip(np.median(own[kept] / white[kept]) / self.rms**2, 1.0, longest)
        )


def covariance(about: Linearised) -> np.ndarray:
    """Covariance (p, p) in the unknowns' sizes, by the scores of the segments.

    What is left of an encoder's counts is no white noise. The priors' part is added.
    """
    inverted = inverse(about.information, about.prior)
    of_prior = (inverted * about.scatter) @ inverted
    return jackknife(about.information, about.blocks, about.scores, about.prior) + of_prior


def _weights(r: np.ndarray, robust: bool) -> np.ndarray:
    """Factors of a residual and of its slopes."""
    return (1.0 + r * r) ** -0.25 if robust else np.ones_like(r)


def _losses(r: np.ndarray, robust: bool) -> np.ndarray:
    return 2.0 * (np.sqrt(1.0 + r * r) - 1.0) if robust else r * r


def _in_spreads(cut: Segments, change: np.ndarray) -> np.ndarray:
    """A change of first states (s, k) in their spreads; 0 where they are known."""
    known = cut.spread > 0.0
    return np.where(known, change / np.where(known, cut.spread, 1.0), 0.0)


def residuals(problem: Problem, values: Values, first: np.ndarray) -> np.ndarray:
    """Measured minus predicted (n, c), in what counts as one; 0 where nothing was measured."""
    cut = problem.cut
    with np.errstate(over="ignore", invalid="ignore"):
        error = (cut.measured - problem.body.outputs(values, first, cut)) * cut.weight
    error[cut.weight == 0.0] = 0.0
    return np.clip(np.nan_to_num(error, nan=FAR), -FAR, FAR)


def evaluated(problem: Problem, values: Values, first: np.ndarray) -> State:
    """The state at values and first states."""
    cut, robust, unknowns = problem.cut, problem.robust, problem.unknowns
    r = residuals(problem, values, first)
    costs = np.add.reduceat(_losses(r, robust).sum(axis=1), cut.bounds[:-1])
    costs = costs + np.sum(_in_spreads(cut, cut.first - first) ** 2, axis=1)
    prior = (unknowns.vector(values) - unknowns.all("mean")) / unknowns.all("spread")
    of_prior = cut.correlated * _losses(prior, robust).sum()
    return State(values, first, r, costs, float(costs.sum() + of_prior))


def linearised(problem: Problem, state: State) -> Linearised:
    """Normal equations of the unknowns, with each segment's own states eliminated."""
    _, cut, unknowns, robust = problem
    count, p, k = len(cut.first), len(unknowns), cut.first.shape[1]
    columns, states = problem.body.slopes(state.values, state.first, cut, unknowns)
    factor = _weights(state.residuals, robust)
    weight = (cut.weight * factor)[:, :, None]
    spreads = np.repeat(cut.spread, cut.lengths, axis=0)[:, None, :]
    columns = _bounded(columns * (weight * unknowns.all("size")), STEEPEST)
    states = _bounded(states * (weight * spreads), STEEP)
    r, off = state.residuals * factor, _in_spreads(cut, cut.first - state.first)
    blocks, scores = np.empty((count, p, p)), np.empty((count, p))
    back, own, promise = np.empty((count, k, p)), np.empty((count, k)), 0.0
    for s, (start, end) in enumerate(itertools.pairwise(cut.bounds)):
        rows = (end - start) * cut.measured.shape[1]
        a, b = columns[start:end].reshape(rows, p), states[start:end].reshape(rows, k)
        y, cross = r[start:end].ravel(), b.T @ a
        right = b.T @ y + off[s]
        solved = np.linalg.solve(b.T @ b + np.eye(k), np.column_stack((cross, right)))
        back[s], own[s] = solved[:, :-1], solved[:, -1]
        promise += float(own[s] @ right)
        blocks[s] = a.T @ a - cross.T @ back[s]
        scores[s] = a.T @ y - cross.T @ own[s]
    spread = unknowns.all("spread")
    prior = (unknowns.vector(state.values) - unknowns.all("mean")) / spread
    slope, certain = unknowns.all("size") / spread, cut.correlated * _weights(prior, robust) ** 2
    gradient = scores.sum(axis=0) - certain * slope * prior
    of_prior = certain * slope**2
    information, scatter = blocks.sum(axis=0) + np.diag(of_prior), certain * of_prior
    return Linearised(
        information,
        gradient,
        blocks,
        scores,
        back,
        own,
        columns,
        states,
        of_prior,
        scatter,
        promise,
    )


def in_blocks(about: Linearised, cut: Segments, state: State, length: float) -> Linearised:
    """The same problem with other blocks: of a ``length`` [s], whatever the segments are.

    First states are those that the linear problem has for no step.
    """
    p, rows, left = len(about.gradient), about.columns.copy(), state.residuals.copy()
    for s, (start, end) in enumerate(itertools.pairwise(cut.bounds)):
        rows[start:end] -= about.states[start:end] @ about.back[s]
        left[start:end] -= about.states[start:end] @ about.own[s]
    of = np.repeat(cut.of, cut.lengths)
    begin = np.flatnonzero(np.diff(of, prepend=-1))
    since = cut.time - np.repeat(cut.time[begin], np.diff([*begin, len(of)]))
    numbers = np.column_stack((of, since // length))
    starts = np.flatnonzero(np.any(np.diff(numbers, axis=0, prepend=-1.0), axis=1))
    pairs = list(itertools.pairwise([*starts, len(of)]))
    blocks = [rows[a:b].reshape(-1, p).T @ rows[a:b].reshape(-1, p) for a, b in pairs]
    scores = [rows[a:b].reshape(-1, p).T @ left[a:b].ravel() for a, b in pairs]
    return about._replace(blocks=np.array(blocks), scores=np.array(scores))


def _bounded(slopes: np.ndarray, most: float) -> np.ndarray:
    np.nan_to_num(slopes, copy=False)
    return np.clip(slopes, -most, most, out=slopes)


def fit(
    problem: Problem, values: Values, first: np.ndarray | None = None, enough: float = FINE
) -> Fit:
    """Minimise the cost from a start; first states are free about the measured ones.

    If none are given, they are solved for first: wrong ones would drive the unknowns away.
    """
    if first is None:
        only = problem._replace(unknowns=Unknowns(()))
        first = _minimum(only, evaluated(only, values, problem.cut.first), COARSE, 1).first
    state = _minimum(problem, evaluated(problem, values, first), enough, SEARCHES)
    return Fit(problem.unknowns, state, linearised(problem, state))


def _minimum(problem: Problem, state: State, enough: float, searches: int) -> State:
    """Descents from a state, with a search of the first speeds after each."""
    for _ in range(searches):
        state = before = _descended(problem, state, enough)
        if problem.body.speed is None:
            break
        usual = max(float(np.median(before.costs / problem.cut.lengths)), 1.0)
        state = _searched(problem, before, BAD * usual * problem.cut.lengths)
        if before.cost - state.cost < max(RESTART * state.cost, enough):
            break
    return state


def _descended(problem: Problem, state: State, enough: float) -> State:
    """Levenberg-Marquardt from a state, until a step promises or gains too little."""
    damping, samples = DAMPING, max(int(np.count_nonzero(problem.cut.weight)), 1)
    for _ in range(MOST_ITERATIONS):
        about = linearised(problem, state)
        least = enough * state.cost / samples
        if about.decrease(_step(problem, state, about, SMALLEST)) < least:
            break
        for _ in range(MOST_TRIES):
            better = _tried(problem, state, about, damping)
            if better.cost < state.cost:
                break
            damping *= FACTOR
        else:
            break
        gain, state = state.cost - better.cost, better
        damping = max(damping / FACTOR, SMALLEST)
        if gain < least:
            break
    return state


def _tried(problem: Problem, state: State, about: Linearised, damping: float) -> State:
    """The state after a damped step.

    If it keeps too little of its promise, first states are solved for once more, and each segment
    takes the best of its own: segments are independent. If a few become worse and the others gain,
    their first speeds are searched: one that begins near rest can stop a whole fit.
    """
    step = _step(problem, state, about, damping)
    vector = problem.unknowns.vector(state.values) + problem.unknowns.all("size") * step
    values = problem.unknowns.changed(state.values, vector)
    shift = np.clip(about.own - np.einsum("skp,p->sk", about.back, step), -LARGEST, LARGEST)
    there = evaluated(problem, values, state.first + shift * problem.cut.spread)
    kept = state.cost - there.cost > KEPT_PROMISE * about.decrease(step)
    if kept or not np.any(problem.cut.spread):
        return there
    choices = [there.first, solved(problem, there, about)]
    if there.cost >= state.cost:
        choices.append(state.first)
    there = evaluated(problem, values, _best_starts(problem, values, choices))
    if there.cost < state.cost:
        return there
    worse = there.costs > BAD * state.costs
    lost = float(np.sum((there.costs - state.costs)[worse]))
    if there.cost - lost >= state.cost or np.mean(worse) > FEW:
        return there
    return _searched(problem, there, BAD * state.costs)


def solved(problem: Problem, state: State, about: Linearised) -> np.ndarray:
    """First states (s, k) after a step of their own, with slopes that are known."""
    cut, k = problem.cut, state.first.shape[1]
    r, off = state.residuals, _in_spreads(cut, cut.first - state.first)
    r = r * _weights(r, problem.robust)
    shift = np.empty_like(state.first)
    for s, (start, end) in enumerate(itertools.pairwise(cut.bounds)):
        b = about.states[start:end].reshape(-1, k)
        shift[s] = np.linalg.solve(b.T @ b + np.eye(k), b.T @ r[start:end].ravel() + off[s])
    return np.asarray(state.first + np.clip(shift, -LARGEST, LARGEST) * cut.spread)


def _step(problem: Problem, state: State, about: Linearised, damping: float) -> np.ndarray:
    """A step (p,) within the bounds, in sizes; what a bound holds does not move the others."""
    vector, size = problem.unknowns.vector(state.values), problem.unknowns.all("size")
    low, high = ((bound - vector) / size for bound in problem.unknowns.bounds(vector))
    weighted = about.information + damping * np.diag(np.diag(about.information))
    # Unknowns have any unit: an unscaled matrix would lose those that act little.
    diagonal = np.diag(weighted)
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    step, free = np.zeros(len(size)), np.ones(len(size), dtype=bool)
    for _ in range(len(size)):
        rest = about.gradient[free] - weighted[np.ix_(free, ~free)] @ step[~free]
        scaled = weighted[np.ix_(free, free)] * np.outer(scale[free], scale[free])
        step[free] = scale[free] * np.linalg.lstsq(scaled, scale[free] * rest, rcond=None)[0]
        outside = free & ((step < low) | (step > high))
        if not np.any(outside):
            break
        step[outside] = np.clip(step, low, high)[outside]
        free &= ~outside
    return np.clip(step, low, high)


def _best_starts(problem: Problem, values: Values, choices: Sequence[np.ndarray]) -> np.ndarray:
    """The best choice of first states for each segment."""
    costs = [evaluated(problem, values, each).costs for each in choices]
    best = np.argmin(costs, axis=0)
    states: np.ndarray = np.array(choices)[best, np.arange(len(best))]
    return states


def _searched(problem: Problem, state: State, allowed: np.ndarray) -> State:
    """The state with the best of several first speeds in segments that cost more than allowed (s,).

    Each speed has the first position that suits it, which is state 0 and output 0. Costs are those
    of residuals that it shifts alike.
    """
    for finer in FINER if problem.body.speed is not None else ():
        bad = np.flatnonzero(state.costs > allowed)
        if not len(bad):
            break
        part = problem._replace(cut=problem.cut.chosen(bad))
        abouts = [state.first[bad], part.cut.first][: 2 if finer == FINER[0] else 1]
        choices = [state.first[bad], _best_speeds(part, state.values, abouts, finer)]
        first = state.first.copy()
        first[bad] = _best_starts(part, state.values, choices)
        state = evaluated(problem, state.values, first)
    return state


def _best_speeds(
    problem: Problem, values: Values, abouts: Sequence[np.ndarray], finer: float
) -> np.ndarray:
    """First states (s, k) of the least cost about some others."""
    cut, speed = problem.cut, problem.body.speed
    weight = cut.weight[0, 0]
    scale = 1.0 / (weight * cut.spread[:, 0])
    best, least = abouts[0], np.full(len(cut.first), np.inf)
    for about, step in itertools.product(abouts, (0.0, *SEARCHED, *(-step for step in SEARCHED))):
        choice = about.copy()
        choice[:, speed] += finer * step * cut.spread[:, speed]
        there = evaluated(problem, values, choice)
        pull = (cut.first[:, 0] - choice[:, 0]) / cut.spread[:, 0]
        shift = np.add.reduceat(there.residuals[:, 0], cut.bounds[:-1]) + pull * scale
        choice[:, 0] += shift / (cut.lengths + scale**2) / weight
        costs = there.costs - shift**2 / (cut.lengths + scale**2)
        better = costs < least
        best, least = np.where(better[:, None], choice, best), np.where(better, costs, least)
    return best


# What one Gauss-Newton step from values leaves: squares of each segment (s,), and the step (p,).
Projection = Callable[[Values], tuple[np.ndarray, np.ndarray]]


def projection(problem: Problem, about: Fit, which: Sequence[int] | None = None) -> Projection:
    """A function of values: squares of each segment after one Gauss-Newton step, and the step.

    The slopes are those of the fit: the values must be near. ``which`` of its unknowns step.
    """
    cut, p, k = problem.cut, len(about.unknowns), problem.cut.first.shape[1]
    which = list(range(p)) if which is None else which
    columns = about.about.columns.reshape(-1, p)[:, which]
    states, channels = about.about.states.reshape(-1, k), cut.measured.shape[1]
    pairs = list(itertools.pairwise(channels * cut.bounds))
    bases = [np.linalg.qr(states[a:b])[0] for a, b in pairs]

    def without(rows: np.ndarray) -> np.ndarray:
        return np.concatenate(
            [rows[a:b] - q @ (q.T @ rows[a:b]) for (a, b), q in zip(pairs, bases, strict=True)]
        )

    columns, linear = without(columns), about.about
    inverted = inverse(linear.information[which][:, which])
    of_prior = (linear.gradient - linear.scores.sum(axis=0))[which]

    def stepped(values: Values) -> tuple[np.ndarray, np.ndarray]:
        left = without(residuals(problem, values, about.state.first).ravel())
        step = inverted @ (columns.T @ left + of_prior)
        left -= columns @ step
        return np.add.reduceat(left**2, channels * cut.bounds[:-1]), step

    return stepped
