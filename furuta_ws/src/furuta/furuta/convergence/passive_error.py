r"""An error signal e = c·x with which the observer satisfies the passivity condition.

With A_c = A + Bl and P > 0 from the Lyapunov equation A_cᵀP + PA_c = −Q, BᵀP(sI − A_c)⁻¹B is
strictly positive real (Kalman–Yakubovich–Popov lemma). The factor of the bristle is included by

.. math::
    c(σ_0I + σ_1A_c) = B^TP \quad\Rightarrow\quad
    G(s) = (σ_1s + σ_0)\,c(sI - A_c)^{-1}B = B^TP(sI - A_c)^{-1}B + σ_1cB

so G is strictly positive real if also cB ≥ 0, which holds if all poles are slower than σ₀/σ₁.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from furuta.convergence.error_loop import error_loop_for
from furuta.convergence.positive_real import strictly_positive_real
from furuta_model.friction.parameters import Friction
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI
from furuta_model.transfer import checked_feedback


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
