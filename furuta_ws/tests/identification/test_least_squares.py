"""The fit itself, on bodies whose answer is known."""

import numpy as np
import pytest

from furuta.identification.bodies.body import Differentiated, Segments
from furuta.identification.least_squares import Problem, fit
from furuta.identification.unknowns import Unknown, Unknowns, Values


class Line(Differentiated):
    """Outputs rise in time; in ``stairs``, as the sums of an integration do."""

    def __init__(self, stairs: float = 0.0) -> None:
        self.stairs = stairs

    def outputs(self, values: Values, first: np.ndarray, cut: Segments) -> np.ndarray:
        """A line through 0 (n, 1)."""
        slope = values["slope"]
        if self.stairs:
            slope = self.stairs * np.round(slope / self.stairs)
        return (slope * cut.time)[:, None]


def series(measured: np.ndarray, time: np.ndarray, correlated: float = 1.0) -> Segments:
    """One segment with a noise of 1 and a known first state."""
    zero = np.zeros((1, 1))
    bounds, of = np.array([0, len(time)]), np.zeros(1, dtype=int)
    ones = np.ones((len(time), 1))
    return Segments(time, measured[:, None], ones, bounds, of, zero, zero, None, correlated)


def test_stairs_do_not_stop_a_fit() -> None:
    """A step of finite differences that is large against them sees the slope behind them."""
    time = np.linspace(0.0, 1.0, 50)
    for step, expected in ((1e-2, 2.0), (1e-6, 1.0)):
        unknown = Unknowns((Unknown("slope", step=step),))
        found = fit(Problem(Line(stairs=1e-4), series(2.0 * time, time), unknown), {"slope": 1.0})
        assert found.values["slope"] == pytest.approx(expected, abs=1e-3)


def test_correlated_samples_carry_the_information_of_one() -> None:
    """A prior counts as much as if each sample had been measured once."""
    time = np.linspace(0.1, 1.0, 10)
    measured = 2.0 * time + np.random.default_rng(1).standard_normal(10)
    unknown = Unknowns((Unknown("slope", spread=0.5),))
    once = fit(Problem(Line(), series(measured, time), unknown), {"slope": 1.0})
    often = series(np.repeat(measured, 40), np.repeat(time, 40), 40.0)
    assert once.values["slope"] < 1.8
    assert fit(Problem(Line(), often, unknown), {"slope": 1.0}).values["slope"] == pytest.approx(
        once.values["slope"], rel=1e-6
    )
