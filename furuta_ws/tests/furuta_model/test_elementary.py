"""Elementary functions: their stated errors, against 80-bit arithmetic, and their limits."""

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import pytest

from furuta_model import elementary

Wide = np.longdouble


def sine(x: float) -> float:
    """First result of sin_cos."""
    return elementary.sin_cos(x)[0]


def cosine(x: float) -> float:
    """Second result of sin_cos."""
    return elementary.sin_cos(x)[1]


@pytest.mark.parametrize(
    ("ours", "theirs", "sizes", "allowed"),
    [
        (elementary.exp, np.exp, (1e-6, 0.3, 1.0, 30.0, 700.0), 1.1),
        (elementary.expm1, np.expm1, (1e-6, 0.3, 1.0, 30.0, 700.0), 2.0),
        (sine, np.sin, (1e-6, 0.1, 1.0, 7.0, 1e3, 1e6), 1.5),
        (cosine, np.cos, (1e-6, 0.1, 1.0, 7.0, 1e3, 1e6), 1.5),
        (elementary.tanh, np.tanh, (1e-6, 0.3, 1.0, 5.0, 30.0), 2.6),
    ],
)
def test_errors_are_as_stated(
    ours: Callable[[float], float], theirs: Any, sizes: tuple[float, ...], allowed: float
) -> None:
    """In units in the last place, for arguments of all sizes and both signs."""
    r = np.random.default_rng(3)
    x = np.concatenate([r.uniform(-size, size, 1000) for size in sizes])
    found = np.array([ours(float(each)) for each in x])
    expected = theirs(x.astype(Wide))
    last_place = np.spacing(np.abs(expected).astype(float))
    assert np.max(np.abs(found.astype(Wide) - expected) / last_place) <= allowed


def test_limits() -> None:
    """NaN stays NaN; what is too large or too small ends at a finite value."""
    for function in (elementary.exp, elementary.expm1, elementary.tanh, sine, cosine):
        assert np.isnan(function(np.nan))
    assert elementary.exp(-800.0) == 0.0
    assert elementary.exp(0.0) == 1.0
    assert elementary.expm1(-800.0) == -1.0
    assert np.isfinite(elementary.exp(800.0))
    assert elementary.tanh(np.inf) == 1.0
    assert elementary.tanh(-np.inf) == -1.0


def test_fused_multiply_add() -> None:
    """Compiled and in exact arithmetic: the same bits, also where a·b cancels with c."""

    @numba.njit
    def compiled(a: float, b: float, c: float) -> float:
        return elementary.fma(a, b, c)

    generator = np.random.default_rng(2)
    for a, b in generator.normal(size=(1000, 2)):
        for c in (0.0, -a * b, generator.normal()):
            assert compiled(a, b, c) == elementary.exact_fma(a, b, c)
