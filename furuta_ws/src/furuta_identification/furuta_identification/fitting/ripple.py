"""Finds torque ripple of the motor in the residuals of the arm's speed."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.optimisation import Optimum
from furuta_model.state import PHI, PHI_DOT

# Waves per turn.
ORDERS = np.arange(2, 61)
# Turns of the arm needed to distinguish an order from its neighbours.
FEWEST_TURNS = 2.0
# The amplitude of the strongest order must exceed the median one by this factor.
SMALLEST_PEAK = 6.0


def strongest_order(optimum: Optimum) -> tuple[int, float]:
    """Waves per turn and their amplitude in arm speed [rad/s]; (0, 0) if none stands out."""
    power, samples = np.zeros(len(ORDERS)), 0
    shooting = optimum.shooting
    predictions = shooting.predictions(optimum.vector)
    for part, predicted in zip(shooting.parts, predictions, strict=True):
        phi, v = part.recording.measured[:, PHI], part.recording.measured[:, PHI_DOT]
        if np.ptp(phi) < FEWEST_TURNS * 2 * np.pi or not np.all(np.isfinite(v)):
            continue
        residual = v - predicted[:, PHI_DOT]
        waves = np.exp(-1j * np.outer(ORDERS, phi))
        power += np.abs(waves @ (residual - residual.mean())) ** 2 / len(residual)
        samples += len(residual)
    best = int(np.argmax(power))
    if not samples or power[best] < SMALLEST_PEAK**2 * float(np.median(power)):
        return 0, 0.0
    return int(ORDERS[best]), float(2.0 * np.sqrt(power[best] / samples))
