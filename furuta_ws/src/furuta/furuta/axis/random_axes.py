"""Random axes whose PID stabilises them without friction."""

from __future__ import annotations

import numpy as np

from furuta.axis.axis import Axis, Pid
from furuta_model.friction.parameters import Friction

# Ranges of the logarithms to base 10: inertia [kg m²], natural frequency [rad/s], Coulomb level
# [N m], damping ratio, and what static friction is above the Coulomb level, relative to it.
LOW = (-4.0, 0.0, -3.0, -1.0, -1.3)
HIGH = (2.0, 2.0, 2.0, 0.3, 0.5)
INTEGRAL = (0.02, 0.95)  # k_i, relative to the largest that is stable, k_p k_d / J


def random_axis(random: np.random.Generator, law: str) -> tuple[Axis, Pid]:
    """An axis under this friction law and a PID that is stable without friction."""
    inertia, frequency, level, damping, excess = 10.0 ** random.uniform(LOW, HIGH)
    friction = Friction(alpha0=level, alpha1=0.0 if law == "coulomb" else excess * level)
    kp, kd = inertia * frequency**2, 2.0 * damping * inertia * frequency
    ki = float(random.uniform(*INTEGRAL)) * kp * kd / inertia
    return Axis(float(inertia), friction, law), Pid(float(kp), ki, float(kd))
