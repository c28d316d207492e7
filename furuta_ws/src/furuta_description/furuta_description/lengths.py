"""Computes the lengths of a pendulum that its normalised model determines."""

from typing import NamedTuple

from furuta_model.pendulum import FurutaPendulum

GRAVITY = 9.81  # [m/s²]


class Lengths(NamedTuple):
    """Lengths [m] of the arm, from axis to pendulum joint, and of the pendulum.

    The pendulum's length is that of the simple pendulum with the same motion: from the joint to the
    centre of oscillation.
    """

    arm: float
    pendulum: float


def lengths(model: FurutaPendulum) -> Lengths:
    """The lengths of a rig with this model.

    With β = J + ml², γ = mLl and δ = mgl of eq. (1), in any unit of torque, L = gγ/δ, and the
    simple pendulum has the length gβ/δ.
    """
    return Lengths(GRAVITY * model.gamma / model.delta, GRAVITY * model.beta / model.delta)
