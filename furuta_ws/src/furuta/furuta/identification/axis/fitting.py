"""Output error over segments, by Gauss-Newton with the segments' first states eliminated."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from furuta.identification.axis.motion import AxisData, AxisModel
from furuta.identification.axis.segments import Segmented
from furuta.identification.axis.slopes import positions_and_slopes
from furuta.identification.errors import jackknife

MOST_ITERATIONS = 30
# Where a motion that leaves all bounds is held, in noises of the position, or per unknown.
FAR = 1e9
# Most searches of the first speeds, and relative gain from which the fit is continued.
SEARCHES, RESTART = 4, 1e-3
# Squares of a segment, in those of the median one, from which its first speed is searched.
BAD = 1.4
# Largest change of a first state in an iteration, in its standard deviations.
LARGEST = 2.0
# Changes of a first speed that are tried where a fit has ended, in its standard deviations.
SEARCHED = (0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
# Decrease of the squares, in those of a sample, at which a fit ends, and one on the way.
FINE, COARSE = 0.05, 2.0


class Unknowns(NamedTuple):
    """What is fitted: names, the size of a usual change of each, and the prior's deviations.

    A name is that of a field of :class:`AxisModel`, ``offset N`` of recording N, or ``cos n`` and
    ``sin n`` of a wave.
    """

    names: tuple[str, ...]
    sizes: np.ndarray
    priors: np.ndarray


class State(NamedTuple):
    """Where a fit is: the model, the segments' first states (s, 2), residuals (n,) and their cost.

    Residuals are in the noise of the position.
    """

    model: AxisModel
    first: np.ndarray
    residuals: np.ndarray
    cost: float


class Linearised(NamedTuple):
    """The least-squares problem about a state, first states eliminated, in the unknowns' sizes.

    ``information`` (p, p) is the sum of the segments' ``blocks`` (s, p, p) and that of the priors,
    ``gradient`` (p,) that of their ``scores`` (s, p). ``back`` and ``own`` give the first states.
    """

    information: np.ndarray
    gradient: np.ndarray
    scores: np.ndarray
    blocks: np.ndarray
    back: np.ndarray
    own: np.ndarray
    columns: np.ndarray
    states: np.ndarray


class Fit(NamedTuple):
    """A fit: where it ended, what was fitted, and what errors are computed from."""

    state: State
    unknowns: Unknowns
    about: Linearised

    @property
    def model(self) -> AxisModel:
        """The fitted model."""
        return self.state.model

    @property
    def cost(self) -> float:
        """Squares of residuals, first states and priors."""
        return self.state.cost

    @property
    def segments(self) -> int:
        """The number of segments."""
        return len(self.about.scores)

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, in the noise of the position."""
        return float(np.sqrt(np.mean(self.state.residuals**2)))

    @property
    def covariance(self) -> np.ndarray:
        """Covariance (p, p) of the unknowns in their sizes, by segments."""
        return covariance(self.about, self.unknowns)

    @property
    def inflation(self) -> float:
        """Variance by segments over that of white noise, at least that of white residuals."""
        white = np.diag(np.linalg.pinv(self.about.information))
        own = np.diag(self.covariance)
        kept = [k for k, name in enumerate(self.unknowns.names) if name in SURE]
        return float(max(np.median(own[kept] / white[kept]), self.rms**2))


# Unknowns that every segment with motion informs of.
SURE = ("inertia", "alpha0", "viscous")
LOWEST = {"delay": 0.0, "alpha0": 0.0, "alpha1": 0.0}


def value_of(model: AxisModel, name: str) -> float:
    """The value of an unknown."""
    kind, _, number = name.partition(" ")
    if kind == "offset":
        return float(model.offsets[int(number)])
    if kind in ("cos", "sin"):
        rows = model.waves[model.waves[:, 0] == int(number)]
        return float(rows[0, 1 if kind == "cos" else 2]) if len(rows) else 0.0
    return float(getattr(model, name))


def changed(model: AxisModel, names: Sequence[str], values: Sequence[float]) -> AxisModel:
    """The model with other values of some unknowns; waves come and go with their amplitudes."""
    offsets, waves = model.offsets.copy(), model.waves.copy()
    fields = {}
    for name, value in zip(names, values, strict=True):
        kind, _, number = name.partition(" ")
        if kind == "offset":
            offsets[int(number)] = value
        elif kind in ("cos", "sin"):
            if not np.any(waves[:, 0] == int(number)):
                waves = np.vstack((waves, [float(number), 0.0, 0.0]))
            waves[waves[:, 0] == int(number), 1 if kind == "cos" else 2] = value
        else:
            fields[name] = float(value)
    waves = waves[np.any(waves[:, 1:] != 0.0, axis=1)]
    return model._replace(offsets=offsets, waves=waves, **fields)


def residuals(model: AxisModel, first: np.ndarray, data: AxisData) -> np.ndarray:
    """Measured minus predicted position (n,), in the noise of the position."""
    out, _ = positions_and_slopes(model, first, data, ())
    far = FAR * data.noise
    return np.clip(np.nan_to_num(data.position - out, posinf=far), -far, far) / data.noise


def linearised(state: State, cut: Segmented, unknowns: Unknowns) -> Linearised:
    """Normal equations of the unknowns, each segment's own states eliminated."""
    model, first, base, _ = state
    data, p, count = cut.data, len(unknowns.names), len(cut.data.starts)
    _, slopes = positions_and_slopes(model, first, data, (*unknowns.names, "q", "v"))
    slopes = np.clip(np.nan_to_num(slopes), -FAR, FAR)
    columns = slopes[:, :p] * (unknowns.sizes / data.noise)
    states = slopes[:, p:] * np.repeat(cut.spread / data.noise, cut.lengths, axis=0)
    prior = (cut.first - first) / cut.spread
    blocks, scores = np.empty((count, p, p)), np.empty((count, p))
    back, own = np.empty((count, 2, p)), np.empty((count, 2))
    for s, (start, end) in enumerate(itertools.pairwise(cut.bounds)):
        a, b, r = columns[start:end], states[start:end], base[start:end]
        cross = b.T @ a
        solved = np.linalg.solve(b.T @ b + np.eye(2), np.column_stack((cross, b.T @ r + prior[s])))
        back[s], own[s] = solved[:, :-1], solved[:, -1]
        blocks[s] = a.T @ a - cross.T @ back[s]
        scores[s] = a.T @ r - cross.T @ own[s]
    weight = (unknowns.sizes / unknowns.priors) ** 2
    values = np.array([value_of(model, name) for name in unknowns.names])
    information = blocks.sum(axis=0) + np.diag(weight)
    gradient = scores.sum(axis=0) - weight * values / unknowns.sizes
    return Linearised(information, gradient, scores, blocks, back, own, columns, states)


def fit(
    cut: Segmented,
    model: AxisModel,
    unknowns: Unknowns,
    first: np.ndarray | None = None,
    enough: float = FINE,
) -> Fit:
    """Minimise the squared residuals from a start; first states are free about the measured."""
    state = _state_of(model, cut.first if first is None else first, cut, unknowns)
    for _ in range(SEARCHES):
        before = _descended(cut, state, unknowns, enough)
        state = _state_of(before.model, _searched(before, cut), cut, unknowns)
        if before.cost - state.cost < max(RESTART * state.cost, enough):
            break
    return Fit(state, unknowns, linearised(state, cut, unknowns))


def _state_of(model: AxisModel, first: np.ndarray, cut: Segmented, unknowns: Unknowns) -> State:
    """The state of a model and first states.

    Its cost are the squares of residuals, of the first states about the measured ones, and of the
    priors.
    """
    base = residuals(model, first, cut.data)
    values = np.array([value_of(model, name) for name in unknowns.names])
    cost = float(
        base @ base
        + np.sum(((first - cut.first) / cut.spread) ** 2)
        + np.sum((values / unknowns.priors) ** 2)
    )
    return State(model, first, base, cost)


def _descended(cut: Segmented, state: State, unknowns: Unknowns, enough: float) -> State:
    """Levenberg-Marquardt from a state."""
    damping = 1e-3
    for _ in range(MOST_ITERATIONS):
        about, better = linearised(state, cut, unknowns), None
        for _ in range(8):
            weighted = about.information + damping * np.diag(np.diag(about.information))
            step = np.linalg.lstsq(weighted, about.gradient, rcond=None)[0]
            new = _stepped(state.model, unknowns, step)
            shift = np.clip(about.own - np.einsum("sip,p->si", about.back, step), -LARGEST, LARGEST)
            there = _state_of(new, state.first + shift * cut.spread, cut, unknowns)
            if there.cost >= state.cost:
                starts = _best_starts(new, (there.first, state.first), cut)
                there = _state_of(new, starts, cut, unknowns)
            if there.cost < state.cost:
                better = there
                break
            damping *= 5.0
        if better is None:
            break
        gain, state = state.cost - better.cost, better
        damping = max(damping / 5.0, 1e-9)
        if gain < enough * max(state.cost / len(state.residuals), 1.0):
            break
    return state


def _best_starts(model: AxisModel, choices: Sequence[np.ndarray], cut: Segmented) -> np.ndarray:
    """The best choice of first states for each segment, which are independent.

    Near rest a residual is no smooth function of the first speed: several are compared.
    """
    costs = [_segment_costs(residuals(model, each, cut.data), each, cut) for each in choices]
    best = np.argmin(costs, axis=0)
    states: np.ndarray = np.array(choices)[best, np.arange(len(best))]
    return states


def _segment_costs(r: np.ndarray, first: np.ndarray, cut: Segmented) -> np.ndarray:
    """Squares of each segment's residuals and first state (s,)."""
    own: np.ndarray = np.add.reduceat(r**2, cut.data.starts)
    return own + np.sum(((first - cut.first) / cut.spread) ** 2, axis=1)


def _searched(state: State, cut: Segmented) -> np.ndarray:
    """First states (s, 2); those of badly explained segments are the best of several speeds.

    Each speed has the first position that suits it.
    """
    squares = _segment_costs(state.residuals, state.first, cut) / cut.lengths
    bad = np.flatnonzero(squares > BAD * max(float(np.median(squares)), 1.0))
    first = state.first.copy()
    if not len(bad):
        return first
    part = cut.chosen(bad)
    data, choices = part.data, [first[bad]]
    scale = data.noise / part.spread[:, 0]
    for about in (first[bad], part.first):
        for step in (0.0, *SEARCHED, *(-step for step in SEARCHED)):
            choice = about + np.array([0.0, step]) * part.spread
            r = residuals(state.model, choice, data)
            pull = (part.first[:, 0] - choice[:, 0]) / part.spread[:, 0]
            shift = (np.add.reduceat(r, data.starts) + pull * scale) / (part.lengths + scale**2)
            choice[:, 0] += shift * data.noise
            choices.append(choice)
    first[bad] = _best_starts(state.model, choices, part)
    return first


def _stepped(model: AxisModel, unknowns: Unknowns, step: np.ndarray) -> AxisModel:
    """The model after a step, within the bounds."""
    values = []
    for name, size, change in zip(unknowns.names, unknowns.sizes, step, strict=True):
        old = value_of(model, name)
        new = old + size * float(change)
        if name in ("inertia", "stribeck_velocity"):
            new = min(max(new, 0.4 * old), 2.5 * old)
        values.append(max(new, LOWEST.get(name, -np.inf)))
    return changed(model, unknowns.names, values)


def projection(cut: Segmented, about: Fit) -> Callable[[AxisModel], np.ndarray]:
    """A function of a model: squares of each segment (s,) after one Gauss-Newton step from it.

    The slopes are those of the fit: the model must be near.
    """
    columns, states = about.about.columns, about.about.states
    pairs = list(itertools.pairwise(cut.bounds))
    bases = [np.linalg.qr(states[a:b])[0] for a, b in pairs]

    def without(values: np.ndarray) -> np.ndarray:
        return np.concatenate(
            [values[a:b] - q @ (q.T @ values[a:b]) for (a, b), q in zip(pairs, bases, strict=True)]
        )

    basis, _ = np.linalg.qr(without(columns))

    def squares(model: AxisModel) -> np.ndarray:
        left = without(residuals(model, about.state.first, cut.data))
        left -= basis @ (basis.T @ left)
        return np.add.reduceat(left**2, cut.data.starts)

    return squares


def covariance(about: Linearised, unknowns: Unknowns) -> np.ndarray:
    """Covariance (p, p) of the unknowns in their sizes, by the scores of the segments.

    What is left of an encoder's counts is no white noise. The priors' part is added.
    """
    inverse = np.linalg.pinv(about.information)
    of_prior = inverse @ np.diag((unknowns.sizes / unknowns.priors) ** 2) @ inverse
    return jackknife(about.information, about.blocks, about.scores) + of_prior
