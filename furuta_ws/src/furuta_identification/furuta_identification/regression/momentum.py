r"""The paper's least squares, on momenta instead of accelerations.

Lagrange's equations of (1) are linear in the model's coefficients. Multiplied by a bump ψ(t) that
is zero, with its slope, at both ends of a window, and integrated by parts, they need no second
derivative of noisy data:

.. math::
    -\intψ̇\,p_φ = \intψ\,(u - F), \qquad
    -\intψ̇\,p_θ - \intψ\,∂T/∂θ = \intψ\,(δ\sinθ - F_θ)

with momenta p_φ = (α + β sin²θ)φ̇ + γ cosθ θ̇ and p_θ = βθ̇ + γ cosθ φ̇. Each window is a row. The
pendulum's equation, divided by δ, gives the ratios β/δ and γ/δ and where the pendulum's zero is;
the arm's gives the rest in volts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.windows import FEWEST, WINDOW, Windows
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum
from furuta_recordings.recording import Recording

# Arm speed [rad/s] below which friction may be anything up to its level, and the part of a window
# that may be so slow.
SLOW = 0.05
SLOW_PART = 0.05


class MomentumFit(NamedTuple):
    """Coefficients by regression, with standard errors ((9,), order of the first nine fields)."""

    alpha: float
    beta: float
    gamma: float
    delta: float
    viscous: float
    coulomb: float
    coulomb_asymmetry: float
    pendulum_viscous: float
    pendulum_coulomb: float
    standard_errors: np.ndarray

    @property
    def body(self) -> FurutaPendulum:
        """The rigid body; raises :class:`ParameterError` where the numbers are of none."""
        body = FurutaPendulum(self.alpha, self.beta, self.gamma, self.delta)
        if min(body) <= 0.0:
            raise ParameterError(f"no pendulum has {body}")
        body.check()
        return body


def ratios(recording: Recording) -> np.ndarray:
    """(β/δ, γ/δ) [s²/rad…] by the pendulum's equation; their signs tell the angles' orientation."""
    return _pendulum_equation(recording, Windows(recording.time)).found[:2]


def pendulum_misfit(recording: Recording) -> float:
    """Part of the pendulum's equation that no coefficients explain, 0 to 1."""
    return _pendulum_equation(recording, Windows(recording.time)).misfit


def arm_misfits(recording: Recording, delays: np.ndarray) -> np.ndarray:
    """Part of the arm's equation that no coefficients explain, 0 to 1, for each delay [s] (k,)."""
    windows = Windows(recording.time)
    beta, gamma = _pendulum_equation(recording, windows).found[:2]
    return np.array(
        [
            _arm_equation(recording.with_delayed_command(delay), windows, beta, gamma).misfit
            for delay in delays
        ]
    )


def momentum_fit(recording: Recording) -> MomentumFit:
    """Regress recording ``recording``, whose speeds are all there and θ = 0 is upright."""
    windows = Windows(recording.time)
    pendulum, pendulum_errors, _ = _pendulum_equation(recording, windows)
    arm, arm_errors, _ = _arm_equation(recording, windows, *pendulum[:2])
    alpha, delta, viscous, forth, back = arm
    one_way = not np.all(np.isfinite(arm_errors[3:]))
    coulomb = forth + back if one_way else 0.5 * (forth + back)
    asymmetry = 0.0 if one_way or coulomb == 0.0 else 0.5 * (forth - back) / coulomb
    scaled = np.append(pendulum[:4] * delta, 0.0)
    errors = delta * pendulum_errors[:4]
    level = np.hypot(arm_errors[3], arm_errors[4]) / 2
    return MomentumFit(
        alpha,
        scaled[0],
        scaled[1],
        delta,
        viscous,
        coulomb,
        asymmetry,
        scaled[2],
        scaled[3],
        np.array(
            [
                arm_errors[0],
                np.hypot(errors[0], pendulum[0] * arm_errors[1]),
                np.hypot(errors[1], pendulum[1] * arm_errors[1]),
                arm_errors[1],
                arm_errors[2],
                level,
                level / max(abs(coulomb), 1e-12),
                errors[2],
                errors[3],
            ]
        ),
    )


class _Regression(NamedTuple):
    """Coefficients (k,), their standard errors, and the part left unexplained."""

    found: np.ndarray
    errors: np.ndarray
    misfit: float


def _pendulum_equation(recording: Recording, windows: Windows) -> _Regression:
    """β/δ, γ/δ, viscous/δ, Coulomb/δ of the joint, then zero and tilt."""
    phi, v, theta, w = recording.measured.T
    s, c = np.sin(theta), np.cos(theta)
    columns = [
        -windows.slope(w) - windows.mean(s * c * v * v),
        -windows.slope(c * v) + windows.mean(s * v * w),
        windows.mean(w),
        windows.mean(np.sign(w)),
        -windows.mean(c),
    ]
    if np.ptp(phi) > 1.0:
        columns += [-windows.mean(c * np.sin(phi)), windows.mean(c * np.cos(phi))]
    return _regress(np.array(columns).T, windows.mean(s))


def _arm_equation(recording: Recording, windows: Windows, beta: float, gamma: float) -> _Regression:
    """α, δ, viscous, Coulomb level forth and back, with β and γ in units of δ.

    Windows in which the arm rests do not count. Where it always turned one way, its Coulomb
    friction cannot be told from a smaller voltage, and is taken for none.
    """
    _, v, theta, w = recording.measured.T
    s, c = np.sin(theta), np.cos(theta)
    forth, back = windows.mean(1.0 * (v > SLOW)), windows.mean(1.0 * (v < -SLOW))
    whole = windows.mean(np.ones(len(v)))
    moving = forth + back > (1.0 - SLOW_PART) * whole
    if min(np.sum(forth[moving]), np.sum(back[moving])) < SLOW_PART * np.sum(whole[moving]):
        forth, back = np.zeros_like(forth), np.zeros_like(back)
    columns = [
        -windows.slope(v),
        -windows.slope(beta * s * s * v + gamma * c * w),
        windows.mean(v),
        forth,
        -back,
    ]
    # What is held over a sample counts half at either end of it.
    earlier = recording.commanded_at(recording.time - recording.interval)
    u = windows.mean(0.5 * (earlier + recording.commanded_at(recording.time)))
    if np.sum(moving) < FEWEST:
        raise ParameterError(
            f"the arm moves in {np.sum(moving)} of {len(u)} windows of {WINDOW:g} s, too few to "
            "fit; record a motion in which it does not rest"
        )
    return _regress(np.array(columns).T[moving], u[moving])


def _regress(x: np.ndarray, y: np.ndarray) -> _Regression:
    """Least squares with standard errors that allow for the windows' overlap.

    What the data never excite stays zero, its standard error infinite.
    """
    scale = np.linalg.norm(x, axis=0)
    used = scale > 0.0
    solution, errors = np.zeros(len(scale)), np.full(len(scale), np.inf)
    x, scale = x[:, used] / scale[used], scale[used]
    found, _, _, _ = np.linalg.lstsq(x, y, rcond=1e-6)
    residual = y - x @ found
    variance = 2.0 * residual @ residual / max(1, len(y) - len(scale))
    solution[used] = found / scale
    errors[used] = np.sqrt(variance * np.diag(np.linalg.pinv(x.T @ x, rcond=1e-12))) / scale
    size = float(np.linalg.norm(y))
    return _Regression(solution, errors, float(np.linalg.norm(residual)) / size if size else 1.0)
