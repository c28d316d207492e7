"""Vibrations are told from friction that changes its sign and from noise."""

import numpy as np
import pytest

from furuta_friction.vibration import (
    RECOVERY_TIME,
    REDUCTION,
    SMALLEST_PART,
    VibrationMemory,
    allowed_share,
    design,
)
from furuta_model.block import block, new_memory

DT, LIMIT = 1e-3, 0.1
DETECTOR = block(design(LIMIT, DT))[0]
TIME = np.arange(0.0, 2.0, DT)


def parts(signal: np.ndarray) -> np.ndarray:
    """The part that may act, after every sample."""
    memory = new_memory(VibrationMemory)[0]
    return np.array([allowed_share(memory, float(value), DETECTOR) for value in signal])


@pytest.mark.parametrize("frequency", [20.0, 150.0])
def test_vibration_is_reduced_within_half_a_second(frequency: float) -> None:
    """To the smallest part."""
    found = parts(3 * LIMIT * np.sin(2 * np.pi * frequency * TIME))
    assert found[500] == pytest.approx(SMALLEST_PART, rel=0.1)


@pytest.mark.parametrize(
    "signal",
    [
        0.5 * LIMIT * np.sin(2 * np.pi * 50.0 * TIME),
        10 * LIMIT * np.sin(2 * np.pi * 1.0 * TIME),
        3 * LIMIT * np.sign(np.sin(2 * np.pi * 4.0 * TIME)),
        0.3 * LIMIT * np.random.default_rng(1).standard_normal(len(TIME)),
    ],
    ids=["small", "slow", "reversals", "noise"],
)
def test_what_is_no_vibration_changes_nothing(signal: np.ndarray) -> None:
    """Small or slow motion, reversals of friction, and noise."""
    assert np.all(parts(signal) == 1.0)


def test_recovery() -> None:
    """A part grows by a factor of e in the recovery time, up to 1."""
    memory = new_memory(VibrationMemory)[0]
    memory["part"] = 1 / REDUCTION
    samples = round(RECOVERY_TIME / DT)
    found = [allowed_share(memory, 0.0, DETECTOR) for _ in range(2 * samples)]
    assert found[samples - 1] == pytest.approx(np.e / REDUCTION, rel=1e-3)
    assert found[-1] == 1.0
