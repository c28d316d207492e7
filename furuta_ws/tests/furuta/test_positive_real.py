"""Positive realness from polynomials, compared with python-control's frequency response."""

import control
import numpy as np
import pytest

from furuta.convergence.positive_real import real_part, strictly_positive_real


def masses(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """(σ₁s + σ₀)/(ms² + ds + k), the loop of [6], which is SPR if and only if σ₁d > σ₀m."""
    rng = np.random.default_rng(7)
    return [
        (np.array([s1, s0]), np.array([m, d, k]))
        for m, d, k, s0, s1 in rng.uniform(0.1, [5, 5, 50, 5, 5], (count, 5))
    ]


@pytest.mark.parametrize(("numerator", "denominator"), masses(20))
def test_a_mass_under_pd(numerator: np.ndarray, denominator: np.ndarray) -> None:
    """The result agrees with the analytical condition; both results occur in the sample."""
    (s1, s0), (m, d, _) = numerator, denominator
    assert strictly_positive_real(numerator, denominator)[0] == bool(s1 * d > s0 * m)
    assert {bool(n[0] * p[1] > n[1] * p[0]) for n, p in masses(20)} == {True, False}


@pytest.mark.parametrize(
    ("numerator", "denominator", "reason"),
    [
        ([1.0], [1.0, 1.0], ""),
        ([1.0, 2.0], [1.0, 1.0], ""),
        ([-1.0], [1.0, 1.0], "real part is -1 at ω = 0"),
        ([1.0], [1.0, 0.0], "pole 0 "),
        ([1.0], [1.0, -1.0], "pole 1 "),
        ([1.0, -1.0], [1.0, 3.0, 2.0], "zero 1 "),
        ([1.0], [1.0, 3.0, 2.0], "2 more poles than zeros"),
        # Re G ω² tends to 0: positive real, but not strictly.
        ([1.0, 3.0], [1.0, 3.0, 2.0], "real part is 0 at ω = inf"),
        # Re G touches zero at ω = 1.
        ([1.0, 0.0, 1.0], [1.0, 2.0, 1.0], "real part is "),
    ],
)
def test_each_part_of_the_definition(
    numerator: list[float], denominator: list[float], reason: str
) -> None:
    """One example violates each condition, and two satisfy all of them."""
    verdict, why = strictly_positive_real(np.array(numerator), np.array(denominator))
    assert verdict == (reason == "")
    assert reason in why


def test_infimum_and_intervals_agree_with_the_curve() -> None:
    """For random stable G the infimum, its frequency and the signs agree with a dense curve."""
    rng = np.random.default_rng(8)
    omega = np.concatenate([[0.0], np.geomspace(1e-4, 1e5, 100_000)])
    kinds = set()
    for _ in range(40):
        denominator = np.poly(-rng.uniform(0.1, 50, 4)).real
        numerator = np.poly(rng.normal(0, 10, rng.integers(1, 5))) * rng.choice([-1.0, 1.0])
        curve = control.tf(numerator, denominator)(1j * omega).real
        part = real_part(numerator, denominator)
        smallest, where = part.smallest
        scale = np.max(np.abs(curve))
        assert smallest <= np.min(curve) + 1e-9 * scale
        assert smallest == pytest.approx(min(np.min(curve), part.at_infinity), abs=1e-6 * scale)
        assert part.at(where) == smallest
        inside = np.zeros(len(omega), bool)
        for low, high in part.not_positive:
            inside |= (omega >= low) & (omega <= high)
        clear = np.abs(curve) > 1e-9 * scale
        assert np.array_equal(inside[clear], curve[clear] < 0.0)
        kinds.add((len(part.not_positive), where == np.inf))
    assert len(kinds) > 3
