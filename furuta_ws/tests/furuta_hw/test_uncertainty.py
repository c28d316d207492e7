"""Rig files with uncertainty: written, read, drawn from."""

from math import log
from pathlib import Path

import numpy as np
import pytest

from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import load_rig, load_uncertain_rig, rig_file_text
from furuta_hw.rigs.uncertainty import Uncertainty, changed_rig
from furuta_model.parts.disturbances import Tilt, TorqueWaves

RIG = Rig()._replace(
    tilt=Tilt(0.02, -0.01), waves=TorqueWaves((1.0, 14.0), (0.01, 0.02), (0.0, -0.03))
)
UNCERTAINTY = Uncertainty(
    ("beta", "alpha0", "delay"),
    np.array([[0.01, 1.8e-3, 0.0], [1.8e-3, 4e-4, 0.0], [0.0, 0.0, 1e-6]]),
)


def test_a_rig_file_is_read_as_written(tmp_path: Path) -> None:
    """All values to nine digits, comments and name included."""
    file = tmp_path / "rig.yaml"
    file.write_text(rig_file_text(RIG, UNCERTAINTY, "a rig", ["first", "second\nline"]))
    rig, uncertainty = load_uncertain_rig(file)
    assert rig.tilt == RIG.tilt
    assert rig.waves == RIG.waves
    assert rig.model == pytest.approx(RIG.model, rel=1e-8)
    assert uncertainty.names == UNCERTAINTY.names
    assert uncertainty.covariance == pytest.approx(UNCERTAINTY.covariance, rel=1e-3, abs=1e-9)
    assert file.read_text().startswith("# first\n# second line\nname: a rig\n")
    assert load_rig(file) == rig


def test_draws_have_the_covariance() -> None:
    """β is drawn by its logarithm; no delay is negative; α keeps the arm's own inertia."""
    changes = UNCERTAINTY.draws(2000, np.random.default_rng(3))
    rigs = [changed_rig(RIG, UNCERTAINTY.names, change) for change in changes]
    beta = np.array([log(each.model.beta / RIG.model.beta) for each in rigs])
    level = np.array([each.friction.alpha0 - RIG.friction.alpha0 for each in rigs])
    drawn = np.cov(beta, level)
    assert drawn == pytest.approx(UNCERTAINTY.covariance[:2, :2], rel=0.15, abs=0.0)
    assert all(each.model.determinant > 0.0 and each.drive.delay >= 0.0 for each in rigs)
    inertia = {round(r.model.alpha - r.model.gamma**2 / r.model.beta, 12) for r in rigs}
    assert len(inertia) == 1
