"""Chooses poles for a rig: those of the linear-quadratic regulator on its model with friction.

Poles that are right for the paper's rig leave hardly any margin on a rig with strong back-EMF: they
would cancel its damping. The regulator keeps stable poles where they are. Its disk margin is about
0.7 or more, whatever the rig.
"""

import numpy as np

from furuta_model.linear import DesiredPoles, linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI, RIGID_STATES

# Arm error [rad] that alone would use the whole voltage: 2 V/rad at 10 V.
FULL_VOLTAGE_ERROR = 5.0
# Relative imaginary part below which a pole counts as real.
REAL = 1e-9


def quadratic_poles(model: FurutaPendulum, viscous: float, voltage: float) -> DesiredPoles:
    """The poles that minimise ∫ (voltage·φ/5 rad)² + u² dt on the model with ``viscous`` friction.

    ``voltage`` [V] is the largest one of the drive, ``viscous`` is in [V s/rad].
    """
    from scipy.linalg import solve_continuous_are  # slow

    a, b = linearize(model, viscous)
    weight = np.zeros((RIGID_STATES, RIGID_STATES))
    weight[PHI, PHI] = (voltage / FULL_VOLTAGE_ERROR) ** 2
    cost = solve_continuous_are(a, b[:, None], weight, np.eye(1))
    poles = np.linalg.eigvals(a - np.outer(b, b @ cost))
    fast, slow = _pairs(poles)
    return DesiredPoles(*fast, *slow)


def _pairs(poles: np.ndarray) -> list[tuple[float, float]]:
    """Natural frequency and damping of two pairs: complex ones, and real ones in order of speed."""
    ordered = sorted(poles, key=lambda pole: (abs(pole.imag) < REAL * abs(pole), -abs(pole)))
    pairs = []
    for first, second in (ordered[:2], ordered[2:]):
        omega = float(np.sqrt((first * second).real))
        pairs.append((omega, float(-(first + second).real / (2.0 * omega))))
    return sorted(pairs, reverse=True)
