r"""Interface of a friction law.

The level g(v) is the magnitude of friction while the arm slides at speed v, without asymmetry:

.. math:: F = ±g(v)(1 ± a) + σ_2 v

With ``bristle``, the arm moves a bristle before it slides, eq. (5), and never truly sticks.
Without it, the arm sticks: at v = 0 friction holds it up to the breakaway level.
"""

from collections.abc import Callable
from typing import NamedTuple

from furuta_model.friction.parameters import Friction


class Law(NamedTuple):
    r"""A friction law.

    ``level`` (compiled) is g(v, p) [V] at speed v [rad/s] with parameters p. ``breakaway``
    (compiled) is the level [V], from p, up to which a stuck arm is held, by default g(0); functions
    of an own law need not be compiled. With ``bristle`` the arm moves a bristle before it slides;
    without ``damped`` σ₁ does not act; with ``springs`` several springs take the bristle's place,
    and analysis is not defined. With ``constant`` the level does not depend on the speed. The last
    three are closed forms for :mod:`furuta.describing_functions.levels`, Python functions of an
    amplitude or a speed [rad/s] and p:
    ``fundamental``, ∫ g(A sin x) sin x dx from 0 to π/2 [V], ``mean``, that of g(A sin x) over a
    cycle [V], and ``slope``, dg/dv at v > 0 [V s/rad].
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
