"""The effect of unmodelled torque that varies with the arm's angle, for free runs."""

from __future__ import annotations

import numpy as np

from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import RIPPLE
from furuta_identification.uncertainty.sensor_errors import noise_of
from furuta_model.state import PHI

# Waves per turn that the unmodelled torque may have.
ORDERS = range(2, 43)
# Usual size of all waves together, as a part of the largest command. It applies where the
# residuals show that the model is incomplete; they need not show its size on a short travel.
USUAL_PART = 0.01
# Amplitude [V] for finite differences.
STEP = 1e-4


def wave_slopes(shooting: Shooting, vector: np.ndarray, residuals: np.ndarray) -> np.ndarray | None:
    """Residuals caused by each wave at its expected size; None where noise explains everything.

    The waves together are at least as large as the residuals beyond the sensors' noise.
    """
    excess = float(residuals @ residuals) - _noise(shooting)
    turns = max(np.ptp(part.recording.measured[:, PHI]) for part in shooting.parts)
    if excess <= 0.0 or turns == 0.0:
        return None
    base = _without_ripple(shooting, vector, residuals)
    columns = [
        (_with_wave(shooting, vector, order, wave) - base) / STEP
        for order in ORDERS
        for wave in ((STEP, 0.0), (0.0, STEP))
    ]
    waves = np.array(columns).T
    largest = max(float(np.max(np.abs(part.recording.command))) for part in shooting.parts)
    usual = USUAL_PART * largest / np.sqrt(waves.shape[1] / 2)
    size: float = max(usual, np.sqrt(excess / float(np.sum(waves**2))))
    return size * waves


def _noise(shooting: Shooting) -> float:
    """The sum of squares that the sensors' noise explains."""
    return sum(
        len(part.recording.time) * float(np.sum((noise_of(part.recording) / part.scale) ** 2))
        for part in shooting.parts
    )


def _with_wave(
    shooting: Shooting, vector: np.ndarray, order: int, wave: tuple[float, float]
) -> np.ndarray:
    """Residuals with one wave of the torque instead of the fitted ripple."""
    ripple = ["ripple_order", *RIPPLE]
    values = shooting.values.changed(ripple, (order, *wave))
    names = [name for name in shooting.names if name not in ripple]
    rest = np.array([vector[shooting.names.index(name)] for name in names])
    return Shooting(shooting.parts, names, values).residuals(rest)


def _without_ripple(shooting: Shooting, vector: np.ndarray, residuals: np.ndarray) -> np.ndarray:
    """Residuals without the fitted ripple."""
    if not set(RIPPLE) & set(shooting.names):
        return residuals
    pairs = zip(shooting.names, vector, strict=True)
    return shooting.residuals(np.array([0.0 if n in RIPPLE else value for n, value in pairs]))
