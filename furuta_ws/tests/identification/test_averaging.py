"""The search for effects, and errors over all models that explain as much."""

import numpy as np
import pytest

from furuta.identification.averaging import (
    Averaged,
    Candidate,
    Catalogue,
    Model,
    Neighbourhood,
    most_probable,
)
from furuta.identification.bodies.body import Differentiated, Segments
from furuta.identification.least_squares import Fit, Problem, fit, linearised
from furuta.identification.unknowns import Key, Unknown, Unknowns, Values

TIME = np.arange(400) / 100.0
# Effects beside a line. The last two are the same over so short a time.
SHAPES = {
    "inertia": TIME,
    "drag": np.sin(3.0 * TIME),
    "spring": np.cos(5.0 * TIME),
    "drift": np.cos(5.0 * TIME) + 1e-3 * TIME**2,
}
CATALOGUE = Catalogue([("drag",), ("spring",), ("drift",)])
NOISE, BLOCK = 0.1, 20


class Shapes(Differentiated):
    """Outputs are a sum of known functions of time."""

    def outputs(self, values: Values, first: np.ndarray, cut: Segments) -> np.ndarray:
        """The sum (n, 1)."""
        return np.sum([values[name] * shape for name, shape in SHAPES.items()], axis=0)[:, None]


def problem_of(measured: np.ndarray, keys: tuple[Key, ...]) -> Problem:
    """In blocks that begin from known states."""
    bounds = np.arange(0, len(TIME) + 1, BLOCK)
    none, of = np.zeros((len(bounds) - 1, 1)), np.zeros(len(bounds) - 1, dtype=int)
    weight = np.full((len(TIME), 1), 1.0 / NOISE)
    cut = Segments(TIME, measured[:, None], weight, bounds, of, none, none, None)
    return Problem(Shapes(), cut, Unknowns(Unknown(key, spread=2.0) for key in keys))


def searched(measured: np.ndarray) -> tuple[Fit, Averaged]:
    """The most probable model, from a line alone, and its errors."""
    none = dict.fromkeys(SHAPES, 0.0)

    def about(best: Fit) -> Neighbourhood:
        wide = problem_of(measured, CATALOGUE.keys(best.keys))
        linear = linearised(wide, best.state)
        return Neighbourhood.of(linear, wide.unknowns, best.values, best, ("inertia",))

    def models(best: Fit) -> list[Candidate]:
        return about(best).candidates(CATALOGUE)

    def refitted(best: Fit, model: Model) -> Fit:
        return fit(problem_of(measured, tuple(model.keys(best.keys))), none)

    best = most_probable(
        fit(problem_of(measured, ("inertia",)), none), models, refitted, ("inertia",)
    )
    there = about(best)
    return best, there.averaged(there.candidates(CATALOGUE))


def measured_with(seed: int, **effects: float) -> np.ndarray:
    """A line with effects and white noise."""
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(TIME))
    return np.asarray(TIME + sum(size * SHAPES[name] for name, size in effects.items()) + noise)


@pytest.mark.parametrize("seed", range(4))
def test_what_acts_is_found_and_nothing_else(seed: int) -> None:
    assert searched(measured_with(seed))[0].keys == ("inertia",)
    best, averaged = searched(measured_with(seed, drag=0.3))
    assert set(best.keys) == {"inertia", "drag"}
    errors = np.sqrt(np.diag(averaged.covariance))
    for key, error, true in zip(best.keys, errors, (1.0, 0.3), strict=True):
        assert abs(best.values[key] - true) < 4.0 * error


def test_an_effect_that_another_explains_as_well_is_as_uncertain_as_it_is_large() -> None:
    """One of two that are alike is fitted; the other may act beside it or in its place."""
    best, averaged = searched(measured_with(0, spring=0.3))
    one = next(key for key in best.keys if key in ("spring", "drift"))
    k = best.keys.index(one)
    assert np.sqrt(averaged.covariance[k, k]) > 0.5 * abs(best.values[one])


def test_a_change_that_a_fit_refuses_is_not_tried_again() -> None:
    """A step that promises more than the fit keeps ends the search after a few."""
    measured = measured_with(0, drag=0.3)
    start = fit(problem_of(measured, ("inertia",)), dict.fromkeys(SHAPES, 0.0))
    tried = []

    def refused(best: Fit, model: Model) -> Fit:
        tried.append(model)
        return best

    candidates = [
        Candidate(Model((), (group,)), np.zeros(1), explained, 0.0)
        for explained, group in zip((3.0, 2.0, 1.0), CATALOGUE.effects, strict=True)
    ]
    same = Candidate(Model((), ()), np.zeros(1), 0.0, 0.0)
    assert most_probable(start, lambda _: [*candidates, same], refused, ("inertia",)) is start
    assert [model.added[0][0] for model in tried] == ["drag", "spring", "drift"]
