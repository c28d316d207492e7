"""The check of a rig file by random rigs."""

from __future__ import annotations

import numpy as np

from furuta.studies.next_experiment import propose
from furuta.studies.rig_check import CHOICES, check_rig
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import CERTAIN, Uncertainty
from furuta_model.pendulum import FurutaPendulum


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


HANGING = Rig(
    limits=Rig().limits._replace(arm_angle=6.0, arm_speed=20.0),
    friction=Rig().friction._replace(viscous=0.1),
)


def test_an_experiment_is_proposed_within_the_limits() -> None:
    """It makes every error smaller, and friction's most if nothing else is uncertain."""
    uncertain = Uncertainty(("delta", "alpha0"), np.diag([0.01**2, 0.02**2]))
    proposal = propose(HANGING, uncertain, 4.0)
    assert proposal is not None
    assert proposal.arm_travel_rad < 6.0
    assert proposal.arm_speed_rad_s < 20.0
    assert all(proposal.after[name] < proposal.before[name] for name in proposal.before)
    assert proposal.gain > 0.0


def test_no_experiment_within_narrow_limits() -> None:
    """An arm that may hardly move cannot be excited."""
    narrow = HANGING._replace(limits=HANGING.limits._replace(arm_angle=0.01))
    assert propose(narrow, Uncertainty(("delta",), np.array([[0.01]])), 2.0) is None
