r"""The transfer function G(s) from the observer's state error to its correction signal.

Near upright, with the true model, a known speed and u = l·x + F̂, the errors z̃ = z − ẑ and
F̃ = F − F̂ = σ₀z̃ + σ₁ż̃ obey

.. math::
    \dot x = (A + Bl)x - B\tilde F, \qquad
    \dot{\tilde z} = -σ_0\frac{|v|}{g(v)}\tilde z + Ke

so e = −G z̃ with G(s) = (σ₁s + σ₀)·(e/u in closed loop). For e = φ

.. math::
    G(s) = \frac{(σ_1s + σ_0)(βs^2 - δ)}{a_0s^4 + a_1s^3 + a_2s^2 + a_3s + a_4}

with the denominator of (10). Its zero √(δ/β) is a zero of the pendulum and independent of l.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from furuta_model.friction.parameters import Friction
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.transfer import checked_feedback, transfer


class ErrorLoop(NamedTuple):
    """G(s) from z̃ to −e, as polynomial coefficients with the highest power first."""

    numerator: np.ndarray
    denominator: np.ndarray

    @property
    def poles(self) -> np.ndarray:
        """Poles [1/s], which are those of the loop without friction."""
        return np.sort_complex(np.roots(self.denominator))

    @property
    def zeros(self) -> np.ndarray:
        """Zeros [1/s]."""
        return np.sort_complex(np.roots(self.numerator))

    @property
    def static_gain(self) -> float:
        """G(0), infinite if s = 0 is a pole."""
        if self.denominator[-1] == 0.0:
            return float(np.copysign(np.inf, self.numerator[-1]))
        return float(self.numerator[-1] / self.denominator[-1])

    @property
    def stable(self) -> bool:
        """Whether all poles lie in the open left half plane."""
        return bool(np.all(self.poles.real < 0.0))

    def at(self, omega: np.ndarray) -> np.ndarray:
        """G(jω) at ω [rad/s]."""
        s = 1j * np.asarray(omega)
        return np.polyval(self.numerator, s) / np.polyval(self.denominator, s)


def error_loop(p: FurutaPendulum, feedback: Sequence[float], friction: Friction) -> ErrorLoop:
    """G(s) for e = φ and u = l·x + F̂, ``feedback`` = l (4,)."""
    g = transfer(p, feedback)
    # φ/u is G of (10), that is v/u, without the factor s.
    return _with_bristle(g.numerator[:-1], g.denominator, friction)


def error_loop_for(
    p: FurutaPendulum, feedback: Sequence[float], friction: Friction, error: Sequence[float]
) -> ErrorLoop:
    """G(s) for an error e = c·x, ``error`` = c (4,), by the Faddeev–LeVerrier algorithm."""
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
    # The last adjugate is zero (Cayley–Hamilton theorem).
    return _with_bristle(numerator[:-1], denominator, friction)


def _with_bristle(
    numerator: Sequence[float], denominator: Sequence[float], friction: Friction
) -> ErrorLoop:
    """The transfer function from u to e times σ₁s + σ₀."""
    product = np.polymul([friction.sigma1, friction.sigma0], numerator)
    return ErrorLoop(np.trim_zeros(product, "f"), np.array(denominator))
