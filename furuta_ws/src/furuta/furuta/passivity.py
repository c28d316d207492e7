r"""Passivity condition for convergence of the observer (9) with its correction −Kφ, [6], [10].

Near upright, with the true model, a known speed and u = l·x + F̂, the errors z̃ = z − ẑ and
F̃ = F − F̂ = σ₀z̃ + σ₁ż̃ obey

.. math::
    \dot x = (A + Bl)x - B\tilde F, \qquad
    \dot{\tilde z} = -σ_0\frac{|v|}{g(v)}\tilde z + Ke

so e = −G z̃ with the denominator of (10) in

.. math::
    G(s) = \frac{(σ_1s + σ_0)(βs^2 - δ)}{a_0s^4 + a_1s^3 + a_2s^2 + a_3s + a_4}

Its zero √(δ/β) is a zero of the pendulum and independent of l. The leak of the bristle makes the
map Ke → z̃ passive. Hence, if ±G with the sign of K is strictly positive real, then x, e and F̃
converge to zero. If the leak is known to be at least λ, it is enough that K G + λ is positive real:
λ = −min Re KG. At rest there is no leak, and the remaining loop is linear, s + K G(s) = 0.

G is strictly positive real (Khalil, *Nonlinear Systems*, Lemma 6.1) if all its poles lie in the
open left half plane, Re G(jω) > 0 for all ω, and at infinity G > 0 or lim ω² Re G > 0. This is
checked with polynomials in w = ω² instead of a grid over ω: with n(jω) = n_e(w) + jω n_o(w), the
even and odd parts of the numerator, and likewise for d,

.. math::
    \mathrm{Re}\,G(jω) = \frac{n_ed_e + w\,n_od_o}{d_e^2 + w\,d_o^2}
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.transfer import transfer
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum

# Re G counts as positive above this fraction of its magnitude; smaller values are rounding errors.
POSITIVE = 1e-9


class Passivity(NamedTuple):
    """The result for a correction gain K [1/s].

    Attributes:
        satisfied: Whether the passivity condition holds.
        reason: Why it holds or does not.
        smallest_real_part: Minimum of Re ±G(jω), with the sign of K; NaN if the loop without
            friction is unstable.
        at_omega_rad_s: Frequency of this minimum.
        holds_above_rad_s: Arm speed above which the condition holds thanks to the leak.
        fastest_growth: Real part of the rightmost pole of the loop without leak at this K [1/s].
    """

    satisfied: bool
    reason: str
    smallest_real_part: float
    at_omega_rad_s: float
    holds_above_rad_s: float
    fastest_growth: float


def observer_passivity(ideal: IdealLoop, gain: float) -> Passivity:
    """The condition for the loop's feedback and friction, and an observer with gain K [1/s]."""
    friction = ideal.law.parameters
    return passivity(*error_loop(ideal.body, ideal.gains, friction), gain, friction)


def error_loop(
    p: FurutaPendulum, feedback: Sequence[float], friction: Friction
) -> tuple[np.ndarray, np.ndarray]:
    """Numerator and denominator of G for ``feedback`` = l (4,), highest power first."""
    g = transfer(p, feedback)
    # φ/u is G of (10), that is v/u, without the factor s.
    product = np.polymul([friction.sigma1, friction.sigma0], g.numerator[:-1])
    return np.trim_zeros(product, "f"), np.array(g.denominator)


def passivity(
    numerator: np.ndarray, denominator: np.ndarray, gain: float, friction: Friction
) -> Passivity:
    """Check the condition for G and an observer with gain K [1/s]."""
    signed = -numerator if gain < 0.0 else numerator
    satisfied, reason = strictly_positive_real(signed, denominator)
    smallest, omega = np.nan, np.nan
    if np.all(np.roots(denominator).real < 0.0):
        smallest, omega = RealPart.of(signed, denominator).smallest
    name = "-G" if gain < 0.0 else "G"
    if gain == 0.0:
        reason = "with K = 0 there is no correction: z̃ decays only with the distance travelled"
    elif satisfied:
        reason = f"{name}, with the sign of K, is strictly positive real"
    else:
        reason = f"{name}, with the sign of K, is not strictly positive real: {reason}"
    needed = abs(gain) * max(-smallest, 0.0) * highest_level(friction) / friction.sigma0
    without_leak = np.polyadd(np.append(denominator, 0.0), gain * numerator)
    return Passivity(
        satisfied and gain != 0.0,
        reason,
        float(smallest),
        float(omega),
        float(needed),
        float(np.max(np.roots(without_leak).real)),
    )


class RealPart(NamedTuple):
    """Re G(jω) = R(w)/D(w), w = (ω/``scale``)², scale [rad/s]."""

    real: Polynomial
    magnitude: Polynomial
    scale: float

    @classmethod
    def of(cls, numerator: np.ndarray, denominator: np.ndarray) -> "RealPart":
        """That of a proper G; coefficients start with the highest power."""
        poles = np.abs(np.roots(denominator))
        poles = poles[poles > 0.0]
        # The geometric mean of the poles makes w of order one.
        scale = float(np.exp(np.mean(np.log(poles)))) if len(poles) else 1.0
        (ne, no), (de, do) = _parts(numerator, scale), _parts(denominator, scale)
        w = Polynomial([0.0, 1.0])
        return cls(ne * de + w * no * do, de * de + w * do * do, scale)

    def at(self, omega: float) -> float:
        """Re G(jω)."""
        if omega < np.inf:
            w = (omega / self.scale) ** 2
            return float(self.real(w) / self.magnitude(w))
        if self.real.degree() < self.magnitude.degree():
            return 0.0
        return float(self.real.coef[-1] / self.magnitude.coef[-1])

    @property
    def smallest(self) -> tuple[float, float]:
        """The infimum of Re G(jω) over ω ≥ 0, and its frequency [rad/s], which may be infinite."""
        slope = self.real.deriv() * self.magnitude - self.real * self.magnitude.deriv()
        # Superfluous candidates do no harm, because Re G takes their values too.
        roots = slope.trim().roots().real
        inner = [self.scale * float(np.sqrt(w)) for w in roots if w > 0.0]
        return min((self.at(omega), omega) for omega in (0.0, *inner, np.inf))


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
    part = RealPart.of(numerator, denominator)
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


def _text(roots: np.ndarray) -> str:
    """The rightmost root as text."""
    root = complex(roots[np.argmax(roots.real)])
    return f"{root.real:.4g}" + (f"±{abs(root.imag):.4g}j" if abs(root.imag) > 0.0 else "")
