"""The fitted model's bristle is that of the plant, to rounding."""

from __future__ import annotations

import numpy as np
import pytest

from furuta_identification.shooting.bristle import bristle_after
from furuta_model.friction import lugre
from furuta_model.friction.parameters import Friction


def test_the_fitted_bristle_is_that_of_the_plant() -> None:
    """At presliding and sliding speeds in both directions, for short and long steps."""
    r = np.random.default_rng(2)
    p = Friction(asymmetry=0.2)
    for _ in range(500):
        v = float(r.choice([-1.0, 1.0]) * 10.0 ** r.uniform(-6, 1.3))
        z, dt = float(r.uniform(-0.003, 0.003)), float(10.0 ** r.uniform(-4, -2))
        expected = lugre.bristle_after(v, 0.0, z, dt, p)
        assert bristle_after(v, z, dt, p) == pytest.approx(expected, abs=1e-15)
