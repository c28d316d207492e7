"""Disturbance observer: the friction that the estimator observes (Ohnishi 1987), limited.

The estimator's ``friction_process_noise`` sets its bandwidth.
"""

from __future__ import annotations

from furuta_model.compiled import inlined


@inlined
def estimate(v: float, observed: float, limit: float, viscous: float) -> float:
    """F̂ [V] at speed v [rad/s] with the ``observed`` friction [V]; |F̂ − σ₂v| ≤ ``limit`` [V]."""
    return min(max(observed - viscous * v, -limit), limit) + viscous * v
