"""The effect of torque that varies with the arm's angle, on the residuals."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import wave_names
from furuta_identification.uncertainty.sensor_errors import noise_of
from furuta_model.state import PHI

# Waves per turn that unmodelled torque may have.
ORDERS = range(2, 43)
# Usual size of all waves together, as a part of the largest command. It applies where the
# residuals show that the model is incomplete; they need not show its size on a short travel.
USUAL_PART = 0.01


def wave_slopes(shooting: Shooting, vector: np.ndarray, residuals: np.ndarray) -> np.ndarray | None:
    """Residuals caused by each wave at its expected size; None where noise explains everything.

    Waves that are part of the model do not count. The others together are at least as large as the
    residuals beyond the sensors' noise.
    """
    excess = float(residuals @ residuals) - _noise(shooting)
    turns = max(np.ptp(part.recording.measured[:, PHI]) for part in shooting.parts)
    if excess <= 0.0 or turns == 0.0:
        return None
    fitted = shooting.values.changed(shooting.names, vector).wave_orders
    rest = [order for order in ORDERS if order not in fitted]
    waves = slopes_in_waves(shooting, vector, rest)
    largest = max(float(np.max(np.abs(part.recording.command))) for part in shooting.parts)
    usual = USUAL_PART * largest / np.sqrt(waves.shape[1] / 2)
    size: float = max(usual, np.sqrt(excess / float(np.sum(waves**2))))
    return size * waves


def slopes_in_waves(shooting: Shooting, vector: np.ndarray, orders: Iterable[int]) -> np.ndarray:
    """∂residuals/∂amplitude of the cosine and the sine wave of each order (n, 2k) [1/V]."""
    added = [name for order in orders for name in wave_names(order)]
    wider = shooting.with_unknowns(added, np.zeros(len(added)))
    return wider.slopes(np.append(vector, np.zeros(len(added))), first=len(vector))


def _noise(shooting: Shooting) -> float:
    """The sum of squares that the sensors' noise explains."""
    return sum(
        len(part.recording.time) * float(np.sum((noise_of(part.recording) / part.scale) ** 2))
        for part in shooting.parts
    )
