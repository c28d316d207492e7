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

An error e = c·x satisfies the passivity condition for a suitable c. With A_c = A + Bl and P > 0
from the Lyapunov equation A_cᵀP + PA_c = −Q, BᵀP(sI − A_c)⁻¹B is strictly positive real
(Kalman–Yakubovich–Popov lemma). The factor of the bristle is included by

.. math::
    c(σ_0I + σ_1A_c) = B^TP \quad\Rightarrow\quad
    G(s) = (σ_1s + σ_0)\,c(sI - A_c)^{-1}B = B^TP(sI - A_c)^{-1}B + σ_1cB

so G is strictly positive real if also cB ≥ 0, which holds if all poles are slower than σ₀/σ₁.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from furuta.convergence.positive_real import strictly_positive_real
from furuta_model.friction.parameters import Friction
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI
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


def passive_error(
    p: FurutaPendulum, feedback: Sequence[float], friction: Friction
) -> np.ndarray | None:
    """Row c (4,) of e = c·x, for K > 0, with c = −1 for φ [rad per rad, rad/s], or None.

    None if the loop without friction is unstable or this construction fails; another c may then
    exist. Q weights a rate like an angle divided by the loop's time constant.
    """
    a, b = linearize(p)
    closed = a + np.outer(b, checked_feedback(feedback))
    poles = np.linalg.eigvals(closed)
    if np.any(poles.real >= 0.0):
        return None
    time = 1.0 / np.exp(np.mean(np.log(np.abs(poles))))
    storage = solve_continuous_lyapunov(closed.T, -np.diag([1.0, time**2, 1.0, time**2]))
    try:
        bristle = friction.sigma0 * np.eye(len(a)) + friction.sigma1 * closed
        c: np.ndarray = np.linalg.solve(bristle.T, b @ storage)
    except np.linalg.LinAlgError:
        return None
    # G(0) = σ₀ c_φ φ/u(0) with φ/u(0) < 0, so c_φ < 0 if G is positive real.
    c = c / abs(c[PHI])
    loop = error_loop_for(p, feedback, friction, c.tolist())
    return c if strictly_positive_real(loop.numerator, loop.denominator)[0] else None
