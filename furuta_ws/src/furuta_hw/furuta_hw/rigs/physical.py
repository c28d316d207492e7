r"""Conversion of masses, lengths and motor constants to the paper's normalised model.

The motor drives the arm through a gear of ratio N. The voltage u acts on its resistance R:

.. math::
    τ = N k_t i, \qquad i = (u - N k_e \dot φ) / R

Eq. (1) holds for torques in N m with α = J_a + N²J_r + mL², β = J_p + ml², γ = mLl, δ = mgl. It is
normalised to the control signal by the volts per N m, κ = R / (N k_t): every coefficient is
multiplied by κ, so that u has the factor 1, and back-EMF adds to the viscous friction:

.. math::
    σ_2 = κ b + N k_e, \qquad α_0 = κ τ_c
"""

from typing import Annotated, NamedTuple

from furuta_model.parameters import About, ParameterError
from furuta_model.pendulum import FurutaPendulum


class PhysicalParameters(NamedTuple):
    """A rig's parameters as in its data sheet. The zero defaults are replaced by the rig file."""

    arm_inertia: Annotated[
        float,
        About("J_a, arm's inertia about its axis, without pendulum", "kg m²", 0.0, 100.0),
    ] = 0.0
    rotor_inertia: Annotated[float, About("J_r, inertia of the rotor", "kg m²", 0.0, 10.0)] = 0.0
    gear_ratio: Annotated[float, About("N, turns of the motor per turn of the arm", "", 1e-3)] = 1.0
    arm_length: Annotated[float, About("L, axis to pendulum joint", "m", 0.0, 5.0)] = 0.0
    pendulum_mass: Annotated[float, About("m, mass of the pendulum", "kg", 0.0, 20.0)] = 0.0
    pendulum_length: Annotated[float, About("l, joint to centre of mass", "m", 0.0, 5.0)] = 0.0
    pendulum_inertia: Annotated[
        float, About("J_p, pendulum's inertia about its centre of mass", "kg m²", 0.0, 100.0)
    ] = 0.0
    gravity: Annotated[float, About("g, gravity", "m/s²", 0.0)] = 9.81
    resistance: Annotated[float, About("R, resistance of the motor", "Ω", 0.0)] = 0.0
    torque_constant: Annotated[float, About("k_t, torque per current", "N m/A", 0.0)] = 0.0
    back_emf_constant: Annotated[float, About("k_e, voltage per speed", "V s/rad", 0.0)] = 0.0
    arm_damping: Annotated[float, About("b, viscous friction at the arm", "N m s/rad", 0.0)] = 0.0
    friction_torque: Annotated[float, About("τ_c, Coulomb friction at the arm", "N m", 0.0)] = 0.0

    def check(self) -> None:
        """Reject a rig without the parameters that the model requires."""
        needed = ("arm_length", "pendulum_mass", "pendulum_length", "resistance", "torque_constant")
        missing = [name for name in needed if getattr(self, name) == 0.0]
        if missing:
            raise ParameterError(f"physical needs {', '.join(missing)} above 0")


class Normalised(NamedTuple):
    """α, β, γ, δ of eq. (1) in volts; σ₂ with back-EMF [V s/rad]; α₀ [V]; 1/κ [N m/V]."""

    model: FurutaPendulum
    viscous: float
    coulomb: float
    torque_per_volt: float


def normalise(p: PhysicalParameters) -> Normalised:
    """The paper's normalised model of a rig."""
    k = p.resistance / (p.gear_ratio * p.torque_constant)  # κ [V/(N m)]
    m, arm, l = p.pendulum_mass, p.arm_length, p.pendulum_length  # noqa: E741
    model = FurutaPendulum(
        alpha=k * (p.arm_inertia + p.gear_ratio**2 * p.rotor_inertia + m * arm**2),
        beta=k * (p.pendulum_inertia + m * l**2),
        gamma=k * m * arm * l,
        delta=k * m * p.gravity * l,
    )
    viscous = k * p.arm_damping + p.gear_ratio * p.back_emf_constant
    return Normalised(model, viscous, k * p.friction_torque, 1.0 / k)
