"""The search that tuning and comparison share, with each method that this scipy has."""

import numpy as np
import pytest
from scipy import optimize

from furuta.studies import trust_region

MINIMUM = np.array([0.3, 1.0])  # the second one at its bound


@pytest.mark.parametrize("method", ["COBYLA", "COBYQA"])
@pytest.mark.parametrize("evaluations", [5, 40])
def test_search(monkeypatch: pytest.MonkeyPatch, method: str, evaluations: int) -> None:
    """It stops in time and is near the minimum within the bounds."""
    if method == "COBYQA" and not hasattr(optimize, "_cobyqa_py"):
        pytest.skip("scipy has COBYQA since 1.14")
    monkeypatch.setattr(trust_region, "SEARCH", method)
    tried = []

    def cost(x: np.ndarray) -> float:
        tried.append((float(np.sum((np.clip(x, 0.0, 1.0) - [0.3, 1.4]) ** 2)), x))
        return tried[-1][0]

    trust_region.search(cost, np.array([0.5, 0.5]), (0.1, 0.01), evaluations, [(0.0, 1.0)] * 2)
    assert len(tried) <= evaluations
    _, best = min(tried, key=lambda trial: trial[0])
    np.testing.assert_allclose(best, MINIMUM, atol=0.04 if evaluations == 40 else 0.5)
