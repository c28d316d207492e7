"""From a recording of an unknown rig to a pendulum that stands: benchmarks/rigs_from_recordings.py.

FURUTA_RIGS=10 tries ten rigs, with longer recordings.
"""

import os
from importlib import import_module

import numpy as np
import pytest
from sources import ROOT

RIGS = int(os.environ.get("FURUTA_RIGS", "1"))
SHORT = 4.0  # recording in the suite [s]


@pytest.mark.long
@pytest.mark.parametrize("seed", range(RIGS))
def test_an_identified_rig_stands(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """With every compensation, and with the recommended one within one count of 0.025 rad."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    study = import_module("rigs_from_recordings")
    if RIGS == 1:
        monkeypatch.setattr(study, "SECONDS", SHORT)
    residuals = study.study(seed)
    assert not np.any(np.isnan(list(residuals.values()))), residuals
    assert residuals["recommended"] < 0.025
