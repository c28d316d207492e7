"""Stability margins, compared with python-control."""

import control
import numpy as np
import pytest

from furuta.margins import margins
from furuta_model.linear import DesiredPoles, linearize, place_poles
from furuta_model.pendulum import FurutaPendulum

BODY = FurutaPendulum()
A, B = linearize(BODY)
POLES = [DesiredPoles(), DesiredPoles(12.0, 1.0, 3.0, 0.5)]


@pytest.mark.parametrize("poles", POLES)
def test_margins_agree_with_python_control(poles: DesiredPoles) -> None:
    gain = place_poles(BODY, poles)
    ours = margins(BODY, gain)
    loop = control.ss(A, B.reshape(-1, 1), gain.reshape(1, -1), 0.0)
    gains, phases, _, _, at, _ = control.stability_margins(loop, returnall=True)
    assert ours.gain_low == pytest.approx(gains[gains < 1.0].max(), rel=1e-6)
    assert ours.gain_high == pytest.approx(gains[gains > 1.0].min(initial=np.inf), rel=1e-6)
    assert np.degrees(ours.phase_rad) == pytest.approx(np.abs(phases).min(), rel=1e-6)
    assert ours.delay_s == pytest.approx((np.radians(np.mod(phases, 360.0)) / at).min(), rel=1e-6)
    disk, _, _ = control.disk_margins(loop, np.geomspace(0.1, 100.0, 400))
    assert ours.disk == pytest.approx(disk, rel=1e-4)
