"""A drive that is known to be late: the torque that acts, and the prediction."""

from math import exp

import numpy as np
import pytest
from scipy.linalg import expm

from furuta_model.block import new_memory
from furuta_model.late_drive import (
    DriveMemory,
    LateDrive,
    acting_torque,
    assume_held,
    design_drive,
    design_prediction,
    predicted,
)
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum

DT = 1e-3
DRIVES = (
    LateDrive(1, 0.0),
    LateDrive(10, 0.0),
    LateDrive(0, 0.02),
    LateDrive(10, 0.015),
    LateDrive(100, 0.001),
)


@pytest.mark.parametrize("drive", DRIVES)
def test_the_torque_is_that_of_a_delay_and_a_lag(drive: LateDrive) -> None:
    """The mean over each sample of the exact solution."""
    memory, p = new_memory(DriveMemory)[0], design_drive(drive, DT)
    voltages = np.random.default_rng(3).normal(0.0, 1.0, 300)
    found = [acting_torque(memory, voltage, p) for voltage in voltages]
    late, torque, expected = np.concatenate([np.zeros(drive.delay), voltages]), 0.0, []
    for voltage in late[:300]:
        if drive.lag:
            times = (np.arange(1000) + 0.5) * DT / 1000
            inside = voltage + (torque - voltage) * np.exp(-times / drive.lag)
            expected.append(inside.mean())
            torque = voltage + (torque - voltage) * exp(-DT / drive.lag)
        else:
            expected.append(voltage)
    assert found == pytest.approx(expected, abs=1e-6)
    assume_held(memory, 0.0)
    assert acting_torque(memory, 0.0, p) == 0.0


@pytest.mark.parametrize("drive", DRIVES)
def test_the_prediction_is_the_motion_to_come(drive: LateDrive) -> None:
    """Of the linear model over delay and lag, the last command held within the lag."""
    a, b = linearize(FurutaPendulum())
    p, of_drive = design_prediction(a, b, drive, DT), design_drive(drive, DT)
    memory, x = new_memory(DriveMemory)[0], np.array([0.1, -0.2, 0.03, 0.4])
    voltages = np.random.default_rng(4).normal(0.0, 1.0, 150)
    for voltage in voltages:
        acting_torque(memory, voltage, of_drive)
    found = [predicted(memory, x, i, p) for i in range(4)]
    step = expm(np.block([[a, b[:, None]], [np.zeros((1, 5))]]) * DT)
    for _ in range(drive.delay + round(drive.lag / DT)):
        torque = acting_torque(memory, voltages[-1], of_drive)
        x = step[:4, :4] @ x + step[:4, 4] * torque
    assert found == pytest.approx(x.tolist(), rel=1e-9)
