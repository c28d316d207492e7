"""Free swings of the pendulum with a held arm."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from furuta_identification.fitting.free_swing import identify_free_swing
from furuta_identification.options import Options
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

OMEGA, DAMPING, FRICTION = 9.34, 0.15, 0.4
COUNT = 2.0 * pi / 8192


def swing(arm: float = 0.0) -> Recording:
    """A pendulum released at 1 rad from hanging, through an encoder; 0 is hanging."""

    def rates(_: float, x: np.ndarray) -> tuple[float, float]:
        dry = FRICTION * np.tanh(x[1] / 0.05)
        return x[1], -(OMEGA**2) * np.sin(x[0]) - DAMPING * x[1] - dry

    time = np.arange(0.0, 8.0, 0.004)
    angle = solve_ivp(rates, (0.0, 8.0), (1.0, 0.0), t_eval=time, rtol=1e-8, atol=1e-9).y[0]
    measured = np.full((len(time), 4), np.nan)
    measured[:, 0] = 0.3 + arm * angle
    measured[:, 2] = COUNT * np.round(angle / COUNT)
    return Recording("swing", time, measured, np.zeros(0), np.zeros(0))


def test_frequency_and_friction() -> None:
    """ω₀ within 0.2 %, friction of the joint within 5 %, with small standard errors."""
    found = identify_free_swing([swing()], Options(angles="rad"))
    omega, damping, friction = found.values.values()
    assert omega == pytest.approx(OMEGA, rel=2e-3)
    assert damping == pytest.approx(DAMPING, rel=0.05)
    assert friction == pytest.approx(FRICTION, rel=0.05)
    assert found.standard_errors["natural_frequency_rad_s"] < 1e-3 * OMEGA
    assert found.fit["swing"] > 99.0


def test_a_moving_arm_is_refused() -> None:
    """Its reaction would change the frequency."""
    with pytest.raises(ParameterError, match=r"the arm moves by .* hold it"):
        identify_free_swing([swing(arm=0.05)], Options(angles="rad"))
