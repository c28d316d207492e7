r"""Does the observer (9) with its correction −Ke converge? The passivity condition of [6], [10].

About upright, with the true model and speed known and u = l·x + F̂, the errors z̃ = z − ẑ and
F̃ = F − F̂ = σ₀z̃ + σ₁ż̃ obey

.. math::
    \dot x = (A + Bl)x - B\tilde F, \qquad
    \dot{\tilde z} = -σ_0\frac{|v|}{g(v)}\tilde z + Ke

so e = −G z̃ with G(s) = (σ₁s + σ₀)·(e/u in closed loop). The leak makes the map Ke → z̃ passive;
hence if ±G, the sign that of K, is strictly positive real, x, e and F̃ vanish. For e = φ

.. math::
    G(s) = \frac{(σ_1s + σ_0)(βs^2 - δ)}{a_0s^4 + a_1s^3 + a_2s^2 + a_3s + a_4}

with the denominator of (10). Its zero √(δ/β) is the pendulum's own and stands whatever l is.

If a leak of at least λ is certain, K G + λ need be positive only: λ = −min Re KG. At rest there is
none, and what is left is linear, s + K G(s) = 0: :attr:`Convergence.largest_stable_gain`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from furuta_analysis.convergence.positive_real import real_part, strictly_positive_real
from furuta_analysis.describing_functions.transfer import checked_feedback, transfer
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import LuGre
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum


class ErrorLoop(NamedTuple):
    """G(s) from z̃ to −e: coefficients, highest power first."""

    numerator: np.ndarray
    denominator: np.ndarray

    @property
    def poles(self) -> np.ndarray:
        """Poles [1/s]: those of the loop without friction."""
        return np.sort_complex(np.roots(self.denominator))

    @property
    def zeros(self) -> np.ndarray:
        """Zeros [1/s]."""
        return np.sort_complex(np.roots(self.numerator))

    @property
    def relative_degree(self) -> int:
        """Poles less zeros."""
        return len(self.denominator) - len(self.numerator)

    @property
    def static_gain(self) -> float:
        """G(0), infinite with a pole there."""
        if self.denominator[-1] == 0.0:
            return float(np.copysign(np.inf, self.numerator[-1]))
        return float(self.numerator[-1] / self.denominator[-1])

    @property
    def high_frequency_gain(self) -> float:
        """Limit of s to the relative degree times G(s)."""
        return float(self.numerator[0] / self.denominator[0])

    @property
    def stable(self) -> bool:
        """Whether all poles lie in the open left half plane."""
        return bool(np.all(self.poles.real < 0.0))

    def at(self, omega: np.ndarray) -> np.ndarray:
        """G(jω) at ω [rad/s]."""
        s = 1j * np.asarray(omega)
        return np.polyval(self.numerator, s) / np.polyval(self.denominator, s)


class Convergence(NamedTuple):
    """The verdict on a correction gain K [1/s].

    ``smallest_real_part`` is that of ±G(jω), the sign that of K, and ``violated_rad_s`` where it is
    negative; NaN and none if the loop without friction is unstable. ``holds_above_rad_s`` is the
    arm speed that, kept, satisfies the condition. ``largest_stable_gain`` is |K| up to which the
    loop without leak is stable, for K > 0 and K < 0; ``fastest_growth`` [1/s] that loop's
    rightmost pole at this K. ``forgetting_travel_rad``: without correction z̃ falls by the factor
    e over it.
    """

    satisfied: bool
    reason: str
    smallest_real_part: float
    at_omega_rad_s: float
    violated_rad_s: tuple[tuple[float, float], ...]
    holds_above_rad_s: float
    largest_stable_gain: tuple[float, float]
    fastest_growth: float
    forgetting_travel_rad: float


def error_loop(p: FurutaPendulum, feedback: Sequence[float], friction: LuGre) -> ErrorLoop:
    """G(s) for e = φ and u = l·x + F̂, ``feedback`` = l (4,)."""
    g = transfer(p, feedback)
    # φ/u is v/u, the G of (10), less its factor s.
    return _with_bristle(g.numerator[:-1], g.denominator, friction)


def error_loop_of(
    p: FurutaPendulum, feedback: Sequence[float], friction: LuGre, error: Sequence[float]
) -> ErrorLoop:
    """G(s) for another error e = c·x, ``error`` = c (4,), by Faddeev and LeVerrier's recursion."""
    a, b = linearize(p)
    closed = a + np.outer(b, checked_feedback(feedback))
    adjugate = np.eye(len(closed))
    row = np.asarray(error, float)
    numerator, denominator = [float(row @ b)], [1.0]
    for power in range(1, len(closed) + 1):
        product = closed @ adjugate
        denominator.append(-float(np.trace(product)) / power)
        adjugate = product + denominator[-1] * np.eye(len(closed))
        numerator.append(float(row @ adjugate @ b))
    # The last adjugate is zero, Cayley and Hamilton's theorem.
    return _with_bristle(numerator[:-1], denominator, friction)


def _with_bristle(
    numerator: Sequence[float], denominator: Sequence[float], friction: LuGre
) -> ErrorLoop:
    """The transfer function from u to e times σ₁s + σ₀."""
    product = np.polymul([friction.sigma1, friction.sigma0], numerator)
    return ErrorLoop(np.trim_zeros(product, "f"), np.array(denominator))


def convergence(loop: ErrorLoop, gain: float, friction: LuGre) -> Convergence:
    """Whether the observer with gain K [1/s] satisfies the condition, and by how much."""
    sign = -1.0 if gain < 0.0 else 1.0
    numerator = sign * loop.numerator
    satisfied, reason = strictly_positive_real(numerator, loop.denominator)
    smallest, omega = np.nan, np.nan
    violated: tuple[tuple[float, float], ...] = ()
    if loop.stable:
        part = real_part(numerator, loop.denominator)
        smallest, omega = part.smallest
        violated = part.not_positive
    return Convergence(
        satisfied and gain != 0.0,
        _reason(satisfied, reason, gain),
        float(smallest),
        float(omega),
        violated,
        float(abs(gain) * max(-smallest, 0.0) * highest_level(friction) / friction.sigma0),
        (largest_stable_gain(loop, 1.0), largest_stable_gain(loop, -1.0)),
        _growth(loop, gain),
        friction.alpha0 * (1.0 + abs(friction.asymmetry)) / friction.sigma0,
    )


def largest_stable_gain(loop: ErrorLoop, sign: float) -> float:
    """|K| [1/s] up to which s + K G(s) = 0, K of this sign, has only roots with Re s < 0.

    0 if already a small K makes it unstable, infinite if none does. Stability changes only where a
    root crosses the imaginary axis, so one K between two such tells of all between them.
    """
    if not loop.stable:
        return 0.0
    crossings = real_part(loop.numerator, loop.denominator).marginal_gains
    magnitudes = sorted(abs(each) for each in crossings if each * sign > 0.0)
    low = 0.0
    for high in [*magnitudes, np.inf]:
        inside = 0.5 * (low + high) if high < np.inf else 2.0 * low + 1.0
        if _growth(loop, sign * inside) >= 0.0:
            return low
        low = high
    return np.inf


def _growth(loop: ErrorLoop, gain: float) -> float:
    """Largest real part [1/s] among the roots of s + K G(s) = 0."""
    characteristic = np.polyadd(np.append(loop.denominator, 0.0), gain * loop.numerator)
    return float(np.max(np.roots(characteristic).real))


def _reason(satisfied: bool, reason: str, gain: float) -> str:
    if gain == 0.0:
        return "K = 0 corrects nothing: z̃ decays with the distance travelled and by nothing else"
    name = "G" if gain > 0.0 else "-G"
    if not satisfied:
        return f"{name}, of the sign of K, is not strictly positive real: {reason}"
    return f"{name}, of the sign of K, is strictly positive real"
