"""Whether standard errors from slopes mean anything, on residuals of one's own."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from furuta.identification.shooting.unknowns import BODY
from furuta.identification.uncertainty.covariance import is_linear

ROWS = 400


def optimum(bend: float) -> Any:
    """Residuals that are linear for ``bend`` 0; otherwise a change of 1/``bend`` counts double."""
    rng = np.random.default_rng(1)
    matrix, noise = rng.standard_normal((4 * ROWS, len(BODY))), rng.standard_normal(4 * ROWS)
    part = SimpleNamespace(
        recording=SimpleNamespace(time=np.linspace(0.0, 4.0, ROWS)), measured=np.zeros(0)
    )
    shooting = SimpleNamespace(
        names=[*BODY],
        parts=[part],
        slopes=lambda x: matrix * (1.0 + 2.0 * bend * x),
        residuals=lambda x: matrix @ (x + bend * x**2) + noise,
    )
    return SimpleNamespace(shooting=shooting, vector=np.zeros(len(BODY)))


def test_residuals_must_not_bend_within_a_standard_error() -> None:
    """The standard errors here are a fortieth; those of a chaotic free run bend far earlier."""
    assert is_linear(optimum(0.0))
    assert is_linear(optimum(1.0))
    assert not is_linear(optimum(1e4))
