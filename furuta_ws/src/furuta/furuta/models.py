"""The linear model, pole placement and friction laws."""

import numpy as np

from furuta_model.friction import laws
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles
from furuta_model.linear import linearize as linear_model
from furuta_model.linear import place_poles as placed
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum


def linearize(pendulum: FurutaPendulum) -> tuple[np.ndarray, np.ndarray]:
    """Linear model ẋ = Ax + B(u − F) about upright, eqs. (2), (3).

    Args:
        pendulum: Coefficients α, β, γ [V s²/rad] and δ [V/rad] of eq. (1).

    Returns:
        A (4, 4) and B (4,), in s, rad and V.

    Raises:
        ParameterError: The inertia matrix is not positive definite.
    """
    pendulum.check()
    return linear_model(pendulum)


def place_poles(pendulum: FurutaPendulum, poles: DesiredPoles) -> np.ndarray:
    """Gain L of u = −Lx that gives the loop these two pole pairs, eq. (7).

    Args:
        pendulum: Coefficients α, β, γ [V s²/rad] and δ [V/rad] of eq. (1).
        poles: ω₁, ω₂ [rad/s] and ζ₁, ζ₂.

    Returns:
        L (4,) [V/rad, V s/rad, V/rad, V s/rad].

    Raises:
        ParameterError: The inertia matrix is not positive definite.
    """
    pendulum.check()
    return placed(pendulum, poles)


def friction_law(name: str, parameters: Friction | None = None) -> laws.FrictionLaw:
    """A friction law with its parameters.

    Args:
        name: coulomb, stiction, stribeck, lugre, dahl or maxwell_slip.
        parameters: Levels [V], bristle [V/rad, V s/rad] and speeds [rad/s]; by default those of
            the paper.

    Returns:
        The law, as :func:`furuta.describing_function` and :class:`furuta.IdealLoop` take it.

    Raises:
        ParameterError: There is no such law.
    """
    if name not in laws.LAWS:
        raise ParameterError(f"no friction law {name}; laws are {', '.join(laws.LAWS)}")
    return laws.friction_law(name, parameters or Friction())
