r"""Equations of motion of the Furuta pendulum, eq. (1), with θ = 0 upright.

.. math::
    (α + β\sin^2θ)\ddot φ + γ\cosθ\,\ddot θ + 2β\cosθ\sinθ\,\dot φ\dot θ - γ\sinθ\,\dot θ^2 = u - F

    γ\cosθ\,\ddot φ + β\ddot θ - β\cosθ\sinθ\,\dot φ^2 - δ\sinθ = 0

Torque and friction are normalised to the control signal, so all coefficients are in volts per
acceleration. The printed equation has a wrong sign and a wrong factor; they are corrected from the
Lagrangian T = ½αφ̇² + ½β(θ̇² + sin²θ φ̇²) + γ cosθ φ̇θ̇, V = δ cosθ.
"""

from typing import Annotated, NamedTuple

from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import sin_cos
from furuta_model.parameters import About, ParameterError

GRAVITY = 9.81  # [m/s²]
# Angle [rad] up to which the series of :func:`rotate_slightly` are exact to rounding.
LARGEST_ROTATION = 0.125


class FurutaPendulum(NamedTuple):
    """Coefficients of (1). The defaults follow from the identified linear model of the rig."""

    alpha: Annotated[
        float, About("inertia of arm, motor and pendulum about the arm's axis", "V s²/rad", 1e-9)
    ] = 87 / 3074
    beta: Annotated[float, About("inertia of the pendulum about its joint", "V s²/rad", 1e-9)] = (
        45 / 3074
    )
    gamma: Annotated[float, About("inertial coupling of the joints", "V s²/rad", 1e-9)] = 29 / 3074
    delta: Annotated[float, About("gravity torque of the pendulum", "V/rad", 1e-9)] = 11 / 29

    def check(self) -> None:
        """Reject an inertia matrix that is not positive definite."""
        if self.alpha * self.beta <= self.gamma**2:
            raise ParameterError(
                "alpha * beta must exceed gamma² (positive definite inertia), given "
                f"alpha = {self.alpha:g}, beta = {self.beta:g}, gamma = {self.gamma:g}"
            )

    @property
    def arm_length(self) -> float:
        """L = gγ/δ [m] from the axis to the pendulum's joint, since γ = mLl and δ = mgl."""
        return GRAVITY * self.gamma / self.delta

    @property
    def pendulum_length(self) -> float:
        """gβ/δ [m], from the joint to the centre of oscillation.

        A simple pendulum of this length moves alike.
        """
        return GRAVITY * self.beta / self.delta

    @property
    def determinant(self) -> float:
        """αβ − γ² [V² s⁴/rad²], the determinant of the upright inertia matrix."""
        return self.alpha * self.beta - self.gamma**2


@compiled
def accelerations(
    phi_dot: float, theta: float, theta_dot: float, torque: float, p: FurutaPendulum
) -> tuple[float, float]:
    """(φ̈, θ̈) [rad/s²] from eq. (1); ``torque`` is u − F [V]."""
    s, c = sin_cos(theta)
    return accelerations_at(phi_dot, s, c, theta_dot, torque, p)


@inlined
def accelerations_at(
    phi_dot: float, s: float, c: float, theta_dot: float, torque: float, p: FurutaPendulum
) -> tuple[float, float]:
    """(φ̈, θ̈) [rad/s²] from eq. (1), if sinθ and cosθ are known."""
    coupling = p.gamma * c
    # The terms with the torque come last: all others can be computed before the torque is known.
    spin = p.gamma * s * theta_dot * theta_dot - 2 * p.beta * c * s * phi_dot * theta_dot
    pendulum = (p.beta * c * phi_dot * phi_dot + p.delta) * s
    inertia = p.alpha + p.beta * s * s
    scale = 1.0 / (inertia * p.beta - coupling * coupling)
    arm = torque + spin
    return (
        p.beta * scale * arm - coupling * scale * pendulum,
        inertia * scale * pendulum - coupling * scale * arm,
    )


@inlined
def rotate_slightly(s: float, c: float, angle: float) -> tuple[float, float]:
    """Rotate an angle with sine ``s`` and cosine ``c`` by ``angle`` [rad]; its sine and cosine.

    By series without a branch, exact to rounding up to :data:`LARGEST_ROTATION`.
    """
    a = angle * angle
    sine = angle * (1.0 - a * (1 / 6 - a * (1 / 120 - a * (1 / 5040 - a * (1 / 362880)))))
    cosine = 1 - a * (0.5 - a * (1 / 24 - a * (1 / 720 - a * (1 / 40320 - a * (1 / 3628800)))))
    return s * cosine + c * sine, c * cosine - s * sine


@compiled
def arm_dynamics(
    phi_dot: float, theta: float, theta_dot: float, p: FurutaPendulum
) -> tuple[float, float]:
    r"""Inertia [V s²/rad] and torque [V] of the arm: eq. (1) solved for u − F = inertia φ̈ + torque.

    With θ̈ from the second line of (1), the first line is

    .. math::
        u - F = \Bigl(α + β\sin^2θ - \frac{γ^2\cos^2θ}{β}\Bigr)\ddot φ
        + γ\cosθ\Bigl(\cosθ\sinθ\,\dot φ^2 + \frac{δ}{β}\sinθ\Bigr)
        + 2β\cosθ\sinθ\,\dot φ\dot θ - γ\sinθ\,\dot θ^2

    The inertia is that of the arm with the pendulum free in its joint. This is partial feedback
    linearisation (Spong 1994).
    """
    s, c = sin_cos(theta)
    coupling = p.gamma * c
    inertia = p.alpha + p.beta * s * s - coupling * coupling / p.beta
    torque = (
        coupling * s * (c * phi_dot * phi_dot + p.delta / p.beta)
        + 2.0 * p.beta * c * s * phi_dot * theta_dot
        - p.gamma * s * theta_dot * theta_dot
    )
    return inertia, torque
