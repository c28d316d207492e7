"""The check of a rig file by random rigs."""

from __future__ import annotations

import numpy as np

from furuta_model.pendulum import FurutaPendulum
from furuta_rig.rig import Rig
from furuta_rig.uncertainty import CERTAIN, Uncertainty
from furuta_studies.rig_check import CHOICES, check_rig


def test_a_well_known_rig_stands_with_every_compensation() -> None:
    """With the level known to 10 %, more friction than assumed leaves more."""
    known = Uncertainty(("alpha0", "beta"), np.diag([0.02**2, 0.001**2]))
    result = check_rig(Rig(), known, 12, 10.0, seed=0)
    assert [row.compensation for row in result.rows] == list(CHOICES)
    assert all(row.falls == 0 for row in result.rows)
    assert result.recommended in ("super_twisting", "combined", "disturbance_observer")
    # 12 draws without a fall: the limit is 1 - 0.05^(1/12).
    assert abs(result.falls_below - (1.0 - 0.05 ** (1.0 / 12))) < 1e-9
    assert {row.compensation: row for row in result.rows}["none"].median_rad > 0.4


def test_a_hopeless_rig_is_reported() -> None:
    """No compensation balances a pendulum with a drive that is much too weak."""
    rig = Rig(model=FurutaPendulum(alpha=2.8, beta=1.46, gamma=0.94, delta=500.0))
    result = check_rig(rig, CERTAIN, 2, 5.0, seed=0)
    assert result.recommended is None
    assert result.falls_below == 1.0
    assert all(row.falls == 2 and np.isnan(row.p95_rad) for row in result.rows)
