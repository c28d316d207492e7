"""Waves of the motor's torque over a turn, seen in what a fit leaves of the arm's speed."""

from __future__ import annotations

import numpy as np

from furuta_identification.shooting.shooting import Shooting
from furuta_model.state import PHI, PHI_DOT

ORDERS = np.arange(2, 61)
# Turns of the arm from which an order can be told from its neighbours.
FEWEST_TURNS = 2.0
# How far the strongest order must stand above the others' median to count.
DISTINCT = 6.0


def strongest_order(shooting: Shooting, vector: np.ndarray) -> tuple[int, float]:
    """Waves a turn and their amplitude in arm speed [rad/s]; (0, 0) where none stands out."""
    power, samples = np.zeros(len(ORDERS)), 0
    for part, predicted in zip(shooting.parts, shooting.predictions(vector), strict=True):
        phi, v = part.recording.measured[:, PHI], part.recording.measured[:, PHI_DOT]
        if np.ptp(phi) < FEWEST_TURNS * 2 * np.pi or not np.all(np.isfinite(v)):
            continue
        left = v - predicted[:, PHI_DOT]
        waves = np.exp(-1j * np.outer(ORDERS, phi))
        power += np.abs(waves @ (left - left.mean())) ** 2 / len(left)
        samples += len(left)
    if not samples:
        return 0, 0.0
    best = int(np.argmax(power))
    if power[best] < DISTINCT**2 * float(np.median(power)):
        return 0, 0.0
    return int(ORDERS[best]), float(2.0 * np.sqrt(power[best] / samples))
