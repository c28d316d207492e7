"""Free swings of the pendulum with a resting arm, as they are recorded."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from furuta.identification.fitting.free_swing import FreeSwing, identify_free_swing
from furuta.identification.options import Options
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

OMEGA, DAMPING, FRICTION = 9.34, 0.25, 0.5
COUNT = 2.0 * pi / 8192
# Time [s] for which the pendulum is held before its release, and after which it rests.
HELD, END = 1.5, 18.0


def swing(
    arm: float = 0.0, release: float = 1.6, drag: float = 0.0, stiffness: float = 0.0, seed: int = 0
) -> Recording:
    """A pendulum that is raised, held and released by hand, until it rests; 0 is hanging.

    Dry friction stops it. The encoder has steps, the clock jitters. ``arm``: its motion as a part
    of the pendulum's; not in the model: ``drag`` [1/rad] of the air, and ``stiffness`` [1/s²] of
    the joint that presliding adds to small motions.
    """

    def rates(_: float, x: np.ndarray) -> tuple[float, float]:
        dry = FRICTION * np.tanh(x[1] / 0.01) + 0.1 * stiffness * np.tanh(x[0] / 0.1)
        resistance = dry + DAMPING * x[1] + drag * x[1] * abs(x[1])
        return x[1], -(OMEGA**2) * np.sin(x[0]) - resistance

    rng = np.random.default_rng(seed)
    time = np.arange(0.0, END, 0.002) + rng.uniform(0.0, 3e-4, round(END / 0.002))
    angle = release * np.clip(time / 0.5, 0.0, 1.0) + 0.01 * np.sin(20.0 * time)
    free = time > HELD
    start, span = angle[~free][-1], (HELD, END + 1.0)
    path = solve_ivp(rates, span, (start, 0.0), "LSODA", time[free], rtol=1e-8, atol=1e-9)
    angle[free] = path.y[0]
    measured = np.full((len(time), 4), np.nan)
    measured[:, 0] = COUNT * np.round((0.3 + arm * angle) / COUNT)
    measured[:, 2] = 0.4 + COUNT * np.round(angle / COUNT)
    return Recording("swing", time, measured, np.zeros(0), np.zeros(0))


def frequency_and_error(found: FreeSwing) -> tuple[float, float]:
    name = "natural_frequency_rad_s"
    return found.values[name], found.standard_errors[name]


@pytest.fixture(scope="module")
def found() -> FreeSwing:
    """The fit of a swing that the model explains."""
    return identify_free_swing([swing()], Options())


def test_frequency_and_friction(found: FreeSwing) -> None:
    """Release, tail at rest and a zero anywhere change nothing."""
    omega, error = frequency_and_error(found)
    assert omega == pytest.approx(OMEGA, rel=1e-3)
    assert abs(omega - OMEGA) < 2.0 * error < 4e-3 * OMEGA
    assert found.values["pendulum_damping_1_s"] == pytest.approx(DAMPING, rel=0.1)
    assert found.values["pendulum_friction_rad_s2"] == pytest.approx(FRICTION, rel=0.1)
    shown = found.to_dict()
    assert shown["fit"]["swing"] > 98.0
    assert shown["usable"] != "no"


@pytest.mark.long
def test_errors_contain_what_the_model_lacks(found: FreeSwing) -> None:
    """Drag and presliding change the frequency with the amplitude, and between recordings."""
    records = [swing(drag=0.02, stiffness=s, seed=1) for s in (0.5, 1.5)]
    (one, of_one), (two, of_two) = (
        frequency_and_error(identify_free_swing([record], Options())) for record in records
    )
    both, of_both = frequency_and_error(identify_free_swing(records, Options()))
    assert min(of_one, of_two) > frequency_and_error(found)[1]
    assert abs(one - two) < 2.0 * np.hypot(of_one, of_two)
    assert max(abs(one - both), abs(two - both)) < 2.0 * of_both


def test_a_moving_arm_is_refused() -> None:
    """Its reaction would change the frequency."""
    with pytest.raises(ParameterError, match=r"the arm moves by 5 % .* hold it"):
        identify_free_swing([swing(arm=0.05)], Options(angles="rad"))


def test_a_recording_without_a_swing_is_refused() -> None:
    """Here it is released too low."""
    with pytest.raises(ParameterError, match="release the pendulum at 1 rad"):
        identify_free_swing([swing(release=0.15)], Options())
