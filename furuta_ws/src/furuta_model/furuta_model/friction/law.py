r"""Interface of a friction law.

The level g(v) is the magnitude of friction while the arm slides at speed v, without asymmetry:

.. math:: F = ±g(v)(1 ± a) + σ_2 v

With ``bristle``, the arm moves a bristle before it slides, eq. (5), and never truly sticks.
Without it, the arm sticks: at v = 0 friction holds it up to the breakaway level.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from furuta_model.friction.parameters import Friction

# Relative step of the central difference for the slope.
STEP = 1e-6


class Law(NamedTuple):
    r"""A friction law.

    ``level`` (compiled) is g(v, p) [V] at speed v [rad/s] with parameters p. ``breakaway``
    (compiled) is the level [V], from p, up to which a stuck arm is held, by default g(0); functions
    of an own law need not be compiled. With ``bristle`` the arm moves a bristle before it slides;
    without ``damped`` σ₁ does not act; with ``springs`` several springs take the bristle's place,
    and analysis is not defined. With ``constant`` the level does not depend on the speed. The last
    three are closed forms, Python functions of an amplitude or a speed [rad/s] and p. Without a
    closed form they are computed from ``level``:

    - ``fundamental``: the constant level [V] with the same fundamental under v = A sin ωt,
      ``∫ g(A sin x) sin x dx`` from 0 to π/2;
    - ``mean``: the mean of g(A sin x) over a cycle [V];
    - ``slope``: dg/dv [V s/rad] at v > 0.
    """

    name: str
    level: Callable[[float, Friction], float]
    breakaway: Callable[[Friction], float] | None = None
    bristle: bool = False
    constant: bool = False
    damped: bool = True
    springs: bool = False
    fundamental: Callable[[float, Friction], float] | None = None
    mean: Callable[[float, Friction], float] | None = None
    slope: Callable[[float, Friction], float] | None = None

    def fundamental_level(self, amplitude: float, p: Friction) -> float:
        """The constant level [V] with the same fundamental at amplitude A [rad/s]."""
        if self.constant:
            return self.level(0.0, p)
        if self.fundamental is not None:
            return self.fundamental(amplitude, p)
        return _quarter_cycle(lambda x: self.level(amplitude * np.sin(x), p) * np.sin(x))

    def mean_level(self, amplitude: float, p: Friction) -> float:
        """Mean level [V] over a cycle of amplitude A [rad/s]."""
        if self.constant:
            return self.level(0.0, p)
        if self.mean is not None:
            return self.mean(amplitude, p)
        return _quarter_cycle(lambda x: self.level(amplitude * np.sin(x), p)) * 2.0 / np.pi

    def level_slope(self, v: float, p: Friction) -> float:
        """dg/dv [V s/rad] at speed v > 0 [rad/s]."""
        if self.constant:
            return 0.0
        if self.slope is not None:
            return self.slope(v, p)
        h = STEP * v
        return (self.level(v + h, p) - self.level(v - h, p)) / (2.0 * h)


def _quarter_cycle(integrand: Callable[[float], float]) -> float:
    from scipy.integrate import quad  # noqa: PLC0415 - nodes, which never need it, start sooner

    return float(quad(integrand, 0.0, 0.5 * np.pi, epsabs=1e-13, epsrel=1e-11, limit=200)[0])
