"""The linear model, pole placement and friction laws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from furuta.describing_functions.describing_function import describing_function
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.loops import checked_loop
from furuta_model.friction import laws
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles
from furuta_model.linear import linearize as linear_model
from furuta_model.linear import place_poles as placed
from furuta_model.optional import needed_by
from furuta_model.parameters import ParameterError, validated
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.simulation.closed_loop import Loop

if TYPE_CHECKING:
    import control

# Names of x.
STATES = ["phi", "phi_dot", "theta", "theta_dot"]


def linearize(loop: Loop | IdealLoop | FurutaPendulum | None = None) -> control.StateSpace:
    """The linear model about upright, eqs. (2), (3), of a closed loop or of the pendulum alone.

    Args:
        loop: A loop, by default that of the paper, whose feedback u = −Lx acts on the true state,
            without sampling and compensation. Viscous friction of its plant is part of the model.
            Or a pendulum, without feedback and friction.

    Returns:
        ẋ = Ax + Bτ with A (4, 4) and B (4, 1), as python-control takes it. The input τ [V] is added
        to the command: −F for the rest of friction, u − F for a pendulum. The outputs are x.

    Raises:
        ParameterError: A value is out of its range.
        ModuleNotFoundError: The package control is not installed.
    """
    with needed_by("furuta.linearize"):
        import control
    body, feedback, viscous = _parts(loop)
    a, b = linear_model(validated(body), viscous)
    names = {"inputs": ["torque"], "outputs": STATES, "states": STATES}
    identity, zero = np.eye(len(b)), np.zeros((len(b), 1))
    return control.ss(a + np.outer(b, feedback), b[:, None], identity, zero, **names)


def _parts(loop: Loop | IdealLoop | FurutaPendulum | None) -> tuple[FurutaPendulum, Any, float]:
    """Pendulum, l (4,) of u = l·x and viscous friction [V s/rad]."""
    if isinstance(loop, FurutaPendulum):
        return loop, np.zeros(len(STATES)), 0.0
    if isinstance(loop, IdealLoop):
        return loop.body, loop.gains, loop.law.parameters.viscous
    loop = checked_loop(loop)
    feedback = -np.array(loop.controller.feedback_gain)
    return loop.plant.model, feedback, loop.plant.friction.parameters.viscous


def place_poles(pendulum: FurutaPendulum, poles: DesiredPoles) -> np.ndarray:
    """Gain L of u = −Lx that gives the loop these two pole pairs, eq. (7).

    It solves (7) exactly; ``control.place`` loses half of the digits where poles meet.

    Args:
        pendulum: Coefficients α, β, γ [V s²/rad] and δ [V/rad] of eq. (1).
        poles: ω₁, ω₂ [rad/s] and ζ₁, ζ₂.

    Returns:
        L (4,) [V/rad, V s/rad, V/rad, V s/rad].

    Raises:
        ParameterError: A value is out of its range, or the inertia matrix is not positive definite.
    """
    return placed(validated(pendulum), validated(poles))


def friction_law(name: str, parameters: Friction | None = None) -> laws.FrictionLaw:
    """A friction law with its parameters.

    Args:
        name: coulomb, stiction, stribeck, lugre, dahl or maxwell_slip.
        parameters: Levels [V], bristle [V/rad, V s/rad] and speeds [rad/s]; by default those of
            the paper.

    Returns:
        The law, as :func:`furuta.describing_function` and :class:`furuta.IdealLoop` take it.

    Raises:
        ParameterError: There is no such law, or a parameter is outside its range.
    """
    if name not in laws.LAWS:
        raise ParameterError(f"no friction law {name}; laws are {', '.join(laws.LAWS)}")
    parameters = parameters or Friction()
    laws.check_friction(name, parameters)
    return laws.friction_law(name, parameters)


def friction_nonlinearity(
    law: laws.FrictionLaw, omega: float | None = None
) -> control.DescribingFunctionNonlinearity:
    """Friction as ``control.describing_function_response`` takes it, beside :func:`linearize`.

    Without its viscous part, which belongs to the linear model. python-control's N depends on the
    amplitude alone: of a ``law`` with a bristle it is that at ``omega`` [rad/s].

    Raises:
        ParameterError: The law is not analysed, or has a bristle and ``omega`` is not above 0.
    """
    with needed_by("furuta.friction_nonlinearity"):
        import control
    law = laws.analysed_law(law.name, law.parameters._replace(viscous=0.0))
    if law.bristle and not (omega and omega > 0.0):
        given = f"omega [rad/s] above 0, given {omega}"
        raise ParameterError(f"the describing function of {law.name} needs {given}")

    class FrictionNonlinearity(control.DescribingFunctionNonlinearity):
        """Friction [V] at steady speed v [rad/s], and its N [V s/rad] at v = A sin ωt."""

        def __call__(self, v: float) -> float:
            return laws.steady_friction(v, law)

        def describing_function(self, A: float) -> complex:  # noqa: N803
            return describing_function(A, omega or 1.0, law)

    return FrictionNonlinearity()
