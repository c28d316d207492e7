"""A single axis, identified from its position and torque."""

import os
from pathlib import Path

import numpy as np
import pytest

from furuta_identification.axis.identify import identify_axis
from furuta_model.parameters import ParameterError
from furuta_recordings.readers.axis_table import read_axis
from furuta_recordings.recording import Recording

INERTIA, LEVEL, VISCOUS, DIFFERENCE = 90.0, 21.0, 190.0, -35.0
OFFSET, DRIFT, COUNT = -2.0, 0.1, 1e-5
# The public training record of the positioning system EMPS, if there is one on this machine.
EMPS = os.environ.get("FURUTA_EMPS_RECORD", "")
FORCE_PER_VOLT = 35.15065  # published


def drive(seconds: float = 8.0, offset: float = OFFSET) -> Recording:
    """A slide in N and m at unequal sample times, by small steps with Coulomb friction."""
    random = np.random.default_rng(3)
    step = 1e-4
    fine = np.arange(0.0, seconds, step)
    force = 40.0 * np.sign(np.sin(4.0 * fine)) + 25.0 * np.sin(11.0 * fine)
    force[fine < 0.1] = 0.0
    held = force[(np.arange(len(fine)) // 10) * 10]
    x, v = np.zeros(len(fine)), 0.0
    for k, u in enumerate(held[:-1]):
        other = offset + DRIFT * (fine[k] - 0.5 * seconds)
        moved = v + step / INERTIA * (u - other - VISCOUS * v - DIFFERENCE * abs(v))
        change = step / INERTIA * LEVEL
        v = np.sign(moved) * max(abs(moved) - change, 0.0)
        x[k + 1] = x[k] + step * v
    chosen = np.arange(0, len(fine), 10) + np.append(0, random.integers(0, 9, len(fine) // 10 - 1))
    measured = np.full((len(chosen), 4), np.nan)
    measured[:, 0] = COUNT * np.round(x[chosen] / COUNT)
    return Recording("slide", fine[chosen], measured, fine[::10], force[::10])


def test_offset_and_drift_do_not_bias_the_axis() -> None:
    """Values within 3 %, or within three standard errors; another recording has its own offset."""
    fit = identify_axis(drive())
    truth = {"inertia": INERTIA, "alpha0": LEVEL, "viscous": VISCOUS, "drift": DRIFT}
    truth |= {"viscous_difference": DIFFERENCE, "offset": OFFSET}
    for name, value in truth.items():
        error = abs(fit.values[name] - value)
        assert error < max(0.03 * abs(value), 3.0 * fit.standard_errors[name]), name
    assert fit.resolution == pytest.approx(COUNT, rel=1e-6)
    assert 0.0 < fit.standard_errors["inertia"] < 0.05 * INERTIA
    other = drive(seconds=4.0, offset=1.0)
    assert fit.error(other, own_offset=True) < 0.1 * fit.error(other)


def test_records_without_information_are_refused() -> None:
    """No number comes without sensitivity: rest, noise, and a torque of another axis."""
    moving = drive(4.0)
    still = moving._replace(measured=np.zeros_like(moving.measured))
    for record in (still, moving._replace(command=-moving.command)):
        with pytest.raises(ParameterError) as caught:
            identify_axis(record)
        assert "\n" not in str(caught.value)


def test_table(tmp_path: Path) -> None:
    """Units of the columns count, and the torque constant."""
    file = tmp_path / "log.csv"
    file.write_text("time_ms,position (mm),reference (mm),current_a\n0,1,7,2\n1,2,7,3\n")
    record = read_axis(file, torque_constant=0.5)
    np.testing.assert_allclose(record.time, [0.0, 1e-3])
    np.testing.assert_allclose(record.measured[:, 0], [1e-3, 2e-3])
    np.testing.assert_allclose(record.command, [1.0, 1.5])
    with pytest.raises(ParameterError, match="--position"):
        read_axis(file, position="angle")
    with pytest.raises(ParameterError, match="--command"):
        read_axis(file, command="torque")


@pytest.mark.long
@pytest.mark.skipif(not EMPS, reason="FURUTA_EMPS_RECORD names no record")
def test_published_drive() -> None:
    """Each half of EMPS's training record predicts the other; the values are near the published."""
    whole = read_axis(Path(EMPS), torque_constant=FORCE_PER_VOLT)
    middle = 0.5 * whole.duration
    first, second = whole.between(-np.inf, middle), whole.between(middle, np.inf)
    for known, held_out in ((first, second), (second, first)):
        fit = identify_axis(known)
        assert fit.values["inertia"] == pytest.approx(95.1, rel=0.07)
        assert fit.values["viscous"] == pytest.approx(203.5, rel=0.1)
        assert fit.values["alpha0"] == pytest.approx(20.39, rel=0.1)
        assert fit.error(held_out, own_offset=True) < 1e-3
