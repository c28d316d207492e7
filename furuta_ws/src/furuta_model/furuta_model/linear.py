"""Linear model about upright, eqs. (2), (3), process noise, pole placement, eqs. (6), (7)."""

from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.parameters import About
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA, THETA_DOT


class DesiredPoles(NamedTuple):
    """The two pole pairs of the closed loop, eq. (7)."""

    omega1: Annotated[float, About("ω₁ of the first pole pair", "rad/s", 0.01, 1e3)] = 7.0
    zeta1: Annotated[float, About("ζ₁ of the first pole pair", "", 0.0, 10.0)] = 0.7
    omega2: Annotated[float, About("ω₂ of the second pole pair", "rad/s", 0.01, 1e3)] = 5.0
    zeta2: Annotated[float, About("ζ₂ of the second pole pair", "", 0.0, 10.0)] = 0.7

    @property
    def polynomial(self) -> np.ndarray:
        """Coefficients (5,) of (7), highest power first."""
        first = [1.0, 2 * self.zeta1 * self.omega1, self.omega1**2]
        second = [1.0, 2 * self.zeta2 * self.omega2, self.omega2**2]
        return np.polymul(first, second)


class KalmanParameters(NamedTuple):
    """Process noise of the Kalman filter."""

    friction_process_noise: Annotated[
        float,
        About(
            "kalman: random change of the friction in one second (process noise)",
            "V/√s",
            1e-3,
            1e3,
        ),
    ] = 0.3
    pendulum_process_noise: Annotated[
        float,
        About(
            "kalman: random change of the pendulum speed in one second (process noise)",
            "rad/s/√s",
            1e-3,
            1e3,
        ),
    ] = 0.1


def linearize(p: FurutaPendulum, viscous: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A (4, 4) and B (4,) of ẋ = Ax + B(u − F), eqs. (2), (3).

    A ``viscous`` friction σ₂ [V s/rad] of the arm is part of A; F is then the rest of the friction.
    """
    a = np.zeros((RIGID_STATES, RIGID_STATES))
    a[PHI, PHI_DOT] = a[THETA, THETA_DOT] = 1.0
    a[PHI_DOT, THETA] = -p.delta * p.gamma / p.determinant
    a[THETA_DOT, THETA] = p.alpha * p.delta / p.determinant
    b = np.zeros(RIGID_STATES)
    b[PHI_DOT] = p.beta / p.determinant
    b[THETA_DOT] = -p.gamma / p.determinant
    a[:, PHI_DOT] -= viscous * b
    return a, b


def from_linear(a23: float, a43: float, b21: float, b41: float) -> FurutaPendulum:
    """The nonlinear model that has this linear model: the inverse of :func:`linearize`.

    δ is a23/b41, and a43/δ, b21, −b41 are the entries of the inverse of [[β, γ], [γ, α]].
    """
    delta = a23 / b41
    alpha_over_determinant = a43 / delta
    determinant = 1.0 / (alpha_over_determinant * b21 - b41**2)
    return FurutaPendulum(
        alpha_over_determinant * determinant, b21 * determinant, -b41 * determinant, delta
    )


def place_poles(p: FurutaPendulum, poles: DesiredPoles, viscous: float = 0.0) -> np.ndarray:
    """L (4,) of u = −Lx that gives the closed loop the characteristic equation (7).

    The closed-loop polynomial is the denominator of (10) with l = −L. Its coefficients are solved
    for L one by one. A ``viscous`` friction σ₂ [V s/rad] already acts like the feedback −σ₂φ̇.
    """
    _, c3, c2, c1, c0 = poles.polynomial
    d = p.determinant
    l1 = d * c0 / p.delta
    l2 = d * c1 / p.delta
    l3 = (d * c2 + p.beta * l1 + p.delta * p.alpha) / p.gamma
    l4 = (d * c3 + p.beta * l2) / p.gamma
    return -np.array([l1, l2 + viscous, l3, l4])
