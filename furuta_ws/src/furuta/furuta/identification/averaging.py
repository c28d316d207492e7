"""Which effects act, and errors over all models that explain a recording about as well.

That is not known, so the posterior of a value is a mixture over models (Hoeting and others 1999):
of the best one, with one effect more, with one less, or with another in its place. Each is one
Gauss-Newton step from the best, and counts by its evidence: how probable its effects are
beforehand, how well it explains the blocks, and how little it could have explained otherwise. The
best one is found by the same steps, each refitted.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple, Protocol, TypeVar

import numpy as np
from scipy.special import log_ndtr, ndtr, stdtrit

from furuta.identification.errors import at_least, inverse, jackknife
from furuta.identification.least_squares import Fit, Linearised
from furuta.identification.unknowns import Key, Unknowns, Values, field_of, name_of

Group = tuple[Key, ...]
# Probability that a body has an effect, before anything is known of it; of a wave of any order.
PROBABLE = {
    "spring": 0.1,
    "gravity_sin": 0.4,
    "viscous_difference": 0.3,
    "drag": 0.3,
    "drift": 0.2,
    "load_friction": 0.2,
    "alpha1": 0.07,
    "delay": 0.3,
    "gravity_friction": 0.2,
    "link": 0.1,
}
A_WAVE, ORDERS = 0.3, range(2, 49)
HARMONIC = sum(1.0 / n for n in ORDERS)
# The effects that are never negative.
LOADED = "load_friction"
NEVER_NEGATIVE = (LOADED, "gravity_friction", "alpha1")
# Largest Occam factor in the errors: effects of any size are as probable, over e decades.
DECADES = 1.0
# Part of the squares that one linear step surely leaves.
LEAST = 1e-3
# Smallest weight of a model that counts.
NEGLIGIBLE = 1e-4
# Parts of a normal distribution beyond two and beyond four standard errors, the latter as often as
# a standard error may fail.
BEYOND = ((2.0, 0.0455), (4.0, 0.005))


# Most changes of a model, and those that a fit may refuse; logarithm of the evidence from which one
# is made.
MOST_CHANGES, MOST_REFUSED, SURER = 15, 3, 0.5


class Catalogue(NamedTuple):
    """Effects that may act; those that depend on the position alone are ``loads`` as well."""

    effects: Sequence[Group]
    loads: Sequence[Group] = ()

    def about(self, known: Iterable[Key]) -> tuple[list[Group], list[Group]]:
        """The effects that a fit of ``known`` unknowns has, and those that it does not have."""
        fitted = set(known)
        present = [group for group in self.effects if group[0] in fitted]
        return present, [group for group in self.effects if group[0] not in fitted]

    def keys(self, known: Sequence[Key]) -> tuple[Key, ...]:
        """The ``known`` unknowns, then those of all other effects."""
        return (*known, *(key for group in self.about(known)[1] for key in group))


class Model(NamedTuple):
    """What differs from the best fit: effects ``dropped`` and ``added``."""

    dropped: tuple[Group, ...]
    added: tuple[Group, ...]

    def keys(self, known: Iterable[Key]) -> list[Key]:
        """Its unknowns, if the best fit has the ``known`` ones."""
        gone = {key for group in self.dropped for key in group}
        return [key for key in known if key not in gone] + [k for each in self.added for k in each]


class Averaged(NamedTuple):
    """Covariance (p, p) in sizes, and the model that contradicts each unknown most (p,), if any.

    ``stiction`` is the standard error of friction that falls at once, if it does, ``load`` the
    largest friction under load that would not show.
    """

    covariance: np.ndarray
    rivals: list[Model | None]
    stiction: float = 0.0
    load: float = 0.0


def described(model: Model) -> str:
    """The effects that would explain as much."""
    names = [
        f"a wave of order {group[0][1]}"
        if field_of(group[0]) == "cos"
        else READ.get(name_of(group[0]), name_of(group[0]))
        for group in model.added
    ]
    names += [] if model.added or model.dropped else ["a fall of friction"]
    return f"{' and '.join(names) or 'less'} would explain as much"


READ = {"gravity_sin": "gravity", "spring": "a spring", "load_friction": "friction under load"}


def neighbours(
    present: Sequence[Group], absent: Sequence[Group], loads: Sequence[Group]
) -> Iterator[Model]:
    """The best model, and those that differ from it by an effect or by an exchange.

    Of the ``loads`` by position two may be exchanged for one: over a short travel they are alike.
    """
    pairs = itertools.combinations([group for group in present if group in loads], 2)
    for dropped in ((), *((group,) for group in present), *pairs):
        yield Model(dropped, ())
        for group in absent:
            yield Model(dropped, (group,))


def explained_by(before: float, after: float, inflation: float) -> float:
    """Logarithm of the evidence that a cost becomes another one, with a noise of any size.

    Squares of so much ``inflation`` are those of independent residuals.
    """
    return float(-0.5 * before / inflation * np.log(max(after / before, LEAST)))


class Candidate(NamedTuple):
    """A model: its step (P,), and the logarithm of its evidence against the best fit.

    That is what it explains more, ``explained``, and what was ``expected`` beforehand. An effect
    that is ``added`` may also be smaller than was expected: that is for the errors. A fall of
    friction has its own ``covered`` (p, p).
    """

    model: Model
    step: np.ndarray
    explained: float
    expected: float
    smaller: float = 0.0
    covered: np.ndarray | None = None

    @property
    def evidence(self) -> float:
        """The logarithm of how much more probable it is than the best fit."""
        return self.explained + self.expected

    @property
    def weight(self) -> float:
        """That for the errors. What seems to be better than the best fit was refused by a fit."""
        return min(self.evidence, 0.0) + self.smaller


class Neighbourhood(NamedTuple):
    """The problem about a fit with all effects of the catalogue, and the models about it.

    ``rows`` are those of the unknowns, of which the first are ``fitted``; ``excess`` is how far
    they are from what is expected, in sizes. ``inflation`` is the variance by blocks over that of
    white noise, ``variance`` that of a residual; so many blocks are ``free``.
    """

    about: Linearised
    rows: dict[Key, int]
    fitted: int
    excess: np.ndarray
    inflation: float
    variance: float
    cost: float
    free: float

    @classmethod
    def of(
        cls, about: Linearised, unknowns: Unknowns, values: Values, best: Fit, sure: Sequence[Key]
    ) -> Neighbourhood:
        """About the ``best`` fit, whose unknowns are the first of all ``unknowns``.

        Every block informs of those that are ``sure``.
        """
        excess = (unknowns.vector(values) - unknowns.all("mean")) / unknowns.all("size")
        rows = {key: number for number, key in enumerate(unknowns.keys)}
        noise = best.inflation(sure), best.rms**2, best.cost, best.segments - best.determined
        return cls(about, rows, len(best.unknowns), excess, *noise)

    def candidates(self, catalogue: Catalogue) -> list[Candidate]:
        """All models about the fit."""
        present, absent = catalogue.about(list(self.rows)[: self.fitted])
        return [self.candidate(each) for each in neighbours(present, absent, catalogue.loads)]

    def candidate(self, model: Model) -> Candidate:
        """One Gauss-Newton step to a model."""
        rows, dropped = _rows(self.rows, self.fitted, model)
        about, step = self.about, np.zeros(len(self.about.gradient))
        step[dropped] = -self.excess[dropped]
        right = about.gradient[rows] - about.information[np.ix_(rows, dropped)] @ step[dropped]
        inverted = inverse(about.information[np.ix_(rows, rows)], about.prior[rows])
        step[rows] = inverted @ right
        expected = smaller = 0.0
        for group in model.added:
            inside = [rows.index(self.rows[key]) for key in group]
            occam = self._occam(group, inverted[np.ix_(inside, inside)])
            expected += log_odds(group) - occam
            smaller += max(occam - DECADES, 0.0)
        if dropped:
            whole = inverse(about.information[: self.fitted, : self.fitted])
            for group in model.dropped:
                inside = [self.rows[key] for key in group]
                occam = self._occam(group, whole[np.ix_(inside, inside)])
                expected += occam - log_odds(group)
                smaller = max(smaller - occam, 0.0)
        for positive in (key for key in NEVER_NEGATIVE if (key,) in model.added):
            # It is never negative: the mean of what is left of its distribution.
            k = rows.index(self.rows[positive])
            deviation = float(np.sqrt(inverted[k, k] * self.inflation))
            above = step[self.rows[positive]] / deviation
            step[rows] += inverted[:, k] / inverted[k, k] * deviation * _beyond_zero(above)
            expected += float(np.log(2.0) + log_ndtr(above))
        gain = float(2.0 * about.gradient @ step - step @ about.information @ step)
        scores = about.scores if gain < 0.0 else about.scores - about.blocks @ step
        size = max(float(step @ about.information @ step), 1e-300)
        inflation = max(self.inflation, float(np.sum((scores @ step) ** 2)) / size)
        explained = explained_by(self.cost, self.cost - gain, inflation)
        return Candidate(model, step, explained, expected, smaller)

    def hidden_load(self) -> float:
        """Largest friction under load that would not show, in its size."""
        if self.rows[LOADED] < self.fitted:
            return 0.0
        rows, _ = _rows(self.rows, self.fitted, Model((), ((LOADED,),)))
        k = rows.index(self.rows[LOADED])
        inverted = inverse(self.about.information[np.ix_(rows, rows)])
        largest = inverted[k] @ self.about.gradient[rows]
        return float(largest + 2.0 * np.sqrt(inverted[k, k] * self.inflation))

    def _occam(self, group: Group, inverted: np.ndarray) -> float:
        """Half the logarithm of how much the segments narrow what was expected of an effect."""
        own = [self.rows[key] for key in group]
        expected = self.about.scatter[own] / np.maximum(self.about.prior[own], 1e-300) ** 2
        ratio = np.sum(np.log(expected)) - np.linalg.slogdet(inverted * self.inflation)[1]
        return max(0.5 * float(ratio), 0.0)

    def covariance(self, model: Model, step: np.ndarray) -> np.ndarray:
        """Covariance (p, p) of the best fit's unknowns in a model; dropped ones have none."""
        about, (rows, _) = self.about, _rows(self.rows, self.fitted, model)
        information = about.information[np.ix_(rows, rows)]
        blocks = about.blocks[:, rows][:, :, rows]
        scores = (about.scores - about.blocks @ step)[:, rows]
        prior = about.prior[rows]
        inverted = inverse(information, prior)
        found = jackknife(information, blocks, scores, prior)
        found = found + (inverted * about.scatter[rows]) @ inverted
        found = at_least(found, inverted * self.variance)
        own = [k for k, row in enumerate(rows) if row < self.fitted]
        covered = np.zeros((self.fitted, self.fitted))
        places = [rows[k] for k in own]
        covered[np.ix_(places, places)] = found[np.ix_(own, own)]
        return covered

    def averaged(self, candidates: Sequence[Candidate]) -> Averaged:
        """Errors over the models; each may have friction under load as well."""
        log_weights = np.array([each.weight for each in candidates])
        likely = [
            c
            for c, k in zip(candidates, log_weights, strict=True)
            if k > log_weights.max() + np.log(NEGLIGIBLE)
        ]
        if LOADED in self.rows and self.rows[LOADED] >= self.fitted:
            more = [
                self.candidate(Model(c.model.dropped, (*c.model.added, (LOADED,))))
                for c in likely
                if (LOADED,) not in c.model.added and c.model.dropped + c.model.added
            ]
            likely += more
        weight = np.exp(np.array([each.weight for each in likely]) - log_weights.max())
        kept = np.flatnonzero(weight > NEGLIGIBLE * weight.sum())
        weight, likely = weight[kept] / weight[kept].sum(), [likely[k] for k in kept]
        shifts = np.array([each.step[: self.fitted] for each in likely])
        covered = [
            self.covariance(each.model, each.step) if each.covered is None else each.covered
            for each in likely
        ]
        total = sum(
            w * (each + np.outer(shift, shift))
            for w, each, shift in zip(weight, covered, shifts, strict=True)
        )
        own = np.array([np.diag(each) for each in covered])
        sigma = mixture_errors(weight, shifts, own * few(self.free))
        apart = weight[:, None] * shifts**2
        rivals = [
            likely[k].model if apart[k, j] > 0.25 * sigma[j] ** 2 else None
            for j, k in enumerate(np.argmax(apart, axis=0))
        ]
        factor = sigma / np.sqrt(np.maximum(np.diag(total), 1e-300))
        return Averaged(total * np.outer(factor, factor), rivals)


def few(freedom: float) -> float:
    """How much larger a variance is to be taken that few blocks tell, so many of them free."""
    return float(0.5 * stdtrit(max(freedom, 3), ndtr(2.0))) ** 2


def _beyond_zero(mean: float) -> float:
    """By how much the positive part of a normal distribution of deviation 1 has a larger mean."""
    return float(np.exp(-0.5 * mean**2 - log_ndtr(mean)) / np.sqrt(2.0 * np.pi))


def log_odds(group: Group) -> float:
    """Of an effect, before anything is known of it; low orders of waves are more probable."""
    wave = field_of(group[0]) == "cos"
    probable = A_WAVE / (int(group[0][1]) * HARMONIC) if wave else PROBABLE[field_of(group[0])]
    return float(np.log(probable / (1.0 - probable)))


def _rows(index: dict[Key, int], count: int, model: Model) -> tuple[list[int], list[int]]:
    dropped = [index[key] for group in model.dropped for key in group]
    added = [index[key] for group in model.added for key in group]
    return [k for k in range(count) if k not in dropped] + added, dropped


def mixture_errors(weight: np.ndarray, shifts: np.ndarray, variances: np.ndarray) -> np.ndarray:
    """Standard errors (p,): few enough of a mixture lie beyond two and beyond four of them."""
    deviations = np.sqrt(variances)
    largest = np.max(np.abs(shifts) + 4.0 * deviations, axis=0)
    found = np.zeros(shifts.shape[1])
    for factor, allowed in BEYOND:
        low, high = np.zeros_like(largest), largest.copy()
        for _ in range(40):
            middle = 0.5 * (low + high)
            with np.errstate(divide="ignore", invalid="ignore"):
                up = ndtr((shifts - factor * middle) / np.maximum(deviations, 1e-300))
                down = ndtr((-shifts - factor * middle) / np.maximum(deviations, 1e-300))
            outside = np.sum(weight[:, None] * (up + down), axis=0)
            low = np.where(outside > allowed, middle, low)
            high = np.where(outside > allowed, high, middle)
        found = np.maximum(found, high)
    return found


class Searched(Protocol):
    """A fit that a search may change."""

    @property
    def keys(self) -> Sequence[Key]:
        """The fitted unknowns."""

    @property
    def cost(self) -> float:
        """That of residuals, first states and priors."""

    def inflation(self, sure: Sequence[Key]) -> float:
        """Variance by blocks over that of white noise."""


Best = TypeVar("Best", bound=Searched)


def most_probable(
    base: Best,
    models: Callable[[Best], Iterable[Candidate]],
    refitted: Callable[[Best, Model], Best],
    sure: Sequence[Key],
) -> Best:
    """The most probable model that is found by single changes, each refitted."""
    best, about, refused = base, list(models(base)), set[frozenset[Key]]()
    for _ in range(MOST_CHANGES):
        left = (c for c in about if frozenset(c.model.keys(best.keys)) not in refused)
        chosen = max(left, key=lambda each: each.evidence)
        if not chosen.evidence > SURER or len(refused) >= MOST_REFUSED:
            break
        other = refitted(best, chosen.model)
        gained = explained_by(best.cost, other.cost, best.inflation(sure)) + chosen.expected
        if gained > 0.0:
            best, about = other, list(models(other))
        else:
            refused.add(frozenset(chosen.model.keys(best.keys)))
    return best
