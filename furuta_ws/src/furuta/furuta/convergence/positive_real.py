r"""Positive realness of a rational G(s), from polynomials in w = ω² instead of a grid over ω.

With n(jω) = n_e(w) + jω n_o(w), the even and odd parts of the numerator, and likewise for d,

.. math::
    \mathrm{Re}\,G(jω) = \frac{n_ed_e + w\,n_od_o}{d_e^2 + w\,d_o^2}

G is strictly positive real (Khalil, *Nonlinear Systems*, Lemma 6.1) if all its poles lie in the
open left half plane, Re G(jω) > 0 for all ω, and at infinity G > 0 or lim ω² Re G > 0.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

# Re G counts as positive above this fraction of its magnitude; smaller values are rounding errors.
POSITIVE = 1e-9


class RealPart(NamedTuple):
    """Re G(jω) = R(w)/D(w), w = (ω/``scale``)², scale [rad/s]."""

    real: Polynomial
    magnitude: Polynomial
    scale: float

    def at(self, omega: float) -> float:
        """Re G(jω)."""
        if omega == np.inf:
            return self.at_infinity
        w = (omega / self.scale) ** 2
        return float(self.real(w) / self.magnitude(w))

    @property
    def at_infinity(self) -> float:
        """Re G(j∞)."""
        if self.real.degree() < self.magnitude.degree():
            return 0.0
        return float(self.real.coef[-1] / self.magnitude.coef[-1])

    @property
    def smallest(self) -> tuple[float, float]:
        """The infimum of Re G(jω) over ω ≥ 0, and its frequency [rad/s], which may be infinite."""
        slope = self.real.deriv() * self.magnitude - self.real * self.magnitude.deriv()
        # Superfluous candidates do no harm, because Re G takes their values too.
        candidates = [(self.at(omega), omega) for omega in (0.0, *self._positive(slope), np.inf)]
        return min(candidates)

    @property
    def not_positive(self) -> tuple[tuple[float, float], ...]:
        """Intervals of ω [rad/s] in which Re G(jω) < 0; the last one may end at infinity.

        Their ends are roots of R. Neighbouring intervals of the same sign are joined, so inaccurate
        and double roots do no harm.
        """
        edges = [0.0, *self._positive(self.real), np.inf]
        intervals: list[tuple[float, float]] = []
        for low, high in pairwise(edges):
            if self.at(_between(low, high, self.scale)) >= 0.0:
                continue
            joined = intervals.pop()[0] if intervals and intervals[-1][1] == low else low
            intervals.append((joined, high))
        return tuple(intervals)

    def _positive(self, polynomial: Polynomial) -> list[float]:
        """ω [rad/s] of the roots in w with positive real part, in ascending order."""
        roots = polynomial.trim().roots().real
        return sorted(self.scale * float(np.sqrt(w)) for w in roots if w > 0.0)


def real_part(numerator: np.ndarray, denominator: np.ndarray) -> RealPart:
    """Re G(jω) for a proper G; coefficients start with the highest power."""
    scale = _scale(denominator)
    (ne, no), (de, do) = _parts(numerator, scale), _parts(denominator, scale)
    w = Polynomial([0.0, 1.0])
    return RealPart(ne * de + w * no * do, de * de + w * do * do, scale)


def strictly_positive_real(numerator: np.ndarray, denominator: np.ndarray) -> tuple[bool, str]:
    """Whether G is strictly positive real, and why not; coefficients with highest power first."""
    numerator, denominator = np.trim_zeros(numerator, "f"), np.trim_zeros(denominator, "f")
    poles, zeros = np.roots(denominator), np.roots(numerator)
    if np.any(poles.real >= 0.0):
        return False, f"it has the pole {_text(poles)} 1/s outside the open left half plane"
    if np.any(zeros.real > 0.0):
        return False, f"it has the zero {_text(zeros)} 1/s in the right half plane"
    excess = len(denominator) - len(numerator)
    if excess > 1:
        return False, f"it has {excess} more poles than zeros, where at most one is allowed"
    part = real_part(numerator, denominator)
    smallest, omega = part.smallest
    size = max(abs(part.at(0.0)), abs(part.at(part.scale)))
    # Re G may approach zero for ω → ∞ if it does so from above and not faster than 1/ω².
    vanishes = omega == np.inf and excess == 1 and _decays_positive(numerator, denominator)
    if smallest > POSITIVE * size or vanishes:
        return True, ""
    return False, f"its real part is {smallest:.4g} at ω = {omega:.4g} rad/s"


def _decays_positive(numerator: np.ndarray, denominator: np.ndarray) -> bool:
    """Whether lim ω² Re G = (n₀d₁ − n₁d₀)/d₀² > 0, for relative degree one."""
    n0, n1 = [*numerator, 0.0][:2]
    gained, lost = n0 * denominator[1], n1 * denominator[0]
    return bool(gained - lost > POSITIVE * (abs(gained) + abs(lost)))


def _parts(coefficients: np.ndarray, scale: float) -> tuple[Polynomial, Polynomial]:
    """Even and odd part in w of a polynomial in s = j ω, with ω = √w ``scale``."""
    ascending = np.asarray(coefficients, float)[::-1]
    ascending = ascending * scale ** np.arange(len(ascending))
    parts = ascending[::2], ascending[1::2]
    even, odd = (part * (-1.0) ** np.arange(len(part)) for part in parts)
    return Polynomial(even), Polynomial(odd if len(odd) else [0.0])


def _scale(denominator: np.ndarray) -> float:
    """Geometric mean of the poles' magnitudes [1/s], which makes w of order one."""
    poles = np.abs(np.roots(denominator))
    poles = poles[poles > 0.0]
    return float(np.exp(np.mean(np.log(poles)))) if len(poles) else 1.0


def _between(low: float, high: float, scale: float) -> float:
    if high == np.inf:
        return 2.0 * max(low, scale)
    return 0.5 * (low + high)


def _text(roots: np.ndarray) -> str:
    """The rightmost root as text."""
    root = complex(roots[np.argmax(roots.real)])
    return f"{root.real:.4g}" + (f"±{abs(root.imag):.4g}j" if abs(root.imag) > 0.0 else "")
