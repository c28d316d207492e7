r"""An error e = c·x for which the observer does satisfy the passivity condition.

With A_c = A + Bl and P > 0 from the Lyapunov equation A_cᵀP + PA_c = −Q, BᵀP(sI − A_c)⁻¹B is
strictly positive real (Kalman, Yakubovich, Popov). The bristle's factor is taken into account by

.. math::
    c(σ_0I + σ_1A_c) = B^TP \quad\Rightarrow\quad
    G(s) = (σ_1s + σ_0)\,c(sI - A_c)^{-1}B = B^TP(sI - A_c)^{-1}B + σ_1cB

so G is strictly positive real if also cB ≥ 0, which holds if all poles are slow beside σ₀/σ₁.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from furuta_analysis.convergence.convergence import error_loop_of
from furuta_analysis.convergence.positive_real import strictly_positive_real
from furuta_analysis.describing_functions.transfer import checked_feedback
from furuta_model.friction.parameters import LuGre
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI


def passive_error(
    p: FurutaPendulum, feedback: Sequence[float], friction: LuGre
) -> np.ndarray | None:
    """Row c (4,) of e = c·x, for K > 0, with c = −1 for φ [rad per rad, rad/s], or None.

    None where the loop without friction is unstable, and where this construction fails; another
    c may then exist. A rate weighs in Q as an angle over the loop's own time.
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
    # G(0) = σ₀ c_φ φ/u(0) and φ/u(0) < 0, so a positive real G has c_φ < 0.
    c = c / abs(c[PHI])
    loop = error_loop_of(p, feedback, friction, c.tolist())
    return c if strictly_positive_real(loop.numerator, loop.denominator)[0] else None
