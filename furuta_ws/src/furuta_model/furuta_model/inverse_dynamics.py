r"""Torque on the arm that gives it a wanted acceleration: eq. (1) solved for u − F.

With θ̈ from the second line of (1), the first line is

.. math::
    u - F = \Bigl(α + β\sin^2θ - \frac{γ^2\cos^2θ}{β}\Bigr)\ddot φ
    + γ\cosθ\Bigl(\cosθ\sinθ\,\dot φ^2 + \frac{δ}{β}\sinθ\Bigr)
    + 2β\cosθ\sinθ\,\dot φ\dot θ - γ\sinθ\,\dot θ^2

This is partial feedback linearisation (Spong 1994).
"""

from math import cos, sin

from furuta_model.compiled import compiled
from furuta_model.pendulum import FurutaPendulum


@compiled
def arm_dynamics(
    phi_dot: float, theta: float, theta_dot: float, p: FurutaPendulum
) -> tuple[float, float]:
    """Inertia [V s²/rad] and torque [V] of the arm: u − F = inertia φ̈ + torque.

    The inertia is that of the arm with the pendulum free in its joint.
    """
    s, c = sin(theta), cos(theta)
    coupling = p.gamma * c
    inertia = p.alpha + p.beta * s * s - coupling * coupling / p.beta
    torque = (
        coupling * s * (c * phi_dot * phi_dot + p.delta / p.beta)
        + 2.0 * p.beta * c * s * phi_dot * theta_dot
        - p.gamma * s * theta_dot * theta_dot
    )
    return inertia, torque
