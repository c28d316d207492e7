"""The linear model, pole placement and friction laws."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from furuta.describing_functions.describing_function import describing_function
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.loops import checked_loop, ideal_loop
from furuta.margins import margins
from furuta.outcomes import sensors_alone
from furuta.passivity import observer_passivity
from furuta.results.linear import LinearModel
from furuta.transfer import FIGURE_4, checked_feedback
from furuta_model.friction import laws
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles
from furuta_model.linear import linearize as linearized
from furuta_model.linear import place_poles as placed
from furuta_model.optional import needed_by
from furuta_model.parameters import ParameterError, validated
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.simulation.closed_loop import Loop

if TYPE_CHECKING:
    import control

# Name of the loop with the controller's or the given feedback, beside those of Fig. 4.
GIVEN = "given"
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
    a, b = linearized(validated(body), viscous)
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


def linear_model(
    loop: Loop | None = None,
    *,
    feedback: Iterable[float] | None = None,
    nyquist: bool = False,
    figure_4: bool = False,
    passivity: bool = False,
) -> LinearModel:
    """The controller's linear model, its poles, gain and margins.

    Args:
        loop: The loop; by default that of the paper.
        feedback: l (4,) of u = l·x instead of the controller's; L = −l.
        nyquist: Whether to add G(jω) from −F to the arm's speed, eq. (10), of the plant's model,
            and where it crosses the real axis: limit cycles are possible at the negative one.
        figure_4: Whether these are the curves of the four feedbacks of Fig. 4 instead.
        passivity: Whether to add the condition under which the LuGre observer converges.

    Raises:
        ParameterError: A value is out of its range, or the plant has what the ideal loop lacks.
    """
    loop = checked_loop(loop)
    controller, model = loop.controller, loop.controller.model
    if feedback is not None and figure_4:
        raise ParameterError("figure_4 has feedbacks of its own: leave out feedback")
    a, b = linearized(model, controller.model_viscous)
    given = None if feedback is None else checked_feedback(list(feedback))
    gain = np.array(controller.feedback_gain) if given is None else -np.array(given)
    closed = np.linalg.eigvals(a - np.outer(b, gain))
    stable = bool(np.all(closed.real < 0.0))
    cases: dict[str, IdealLoop] = {}
    condition = None
    if nyquist or figure_4 or passivity:
        ideal = ideal_loop(loop, {}, "lugre", given)
        feedbacks = FIGURE_4 if figure_4 else {GIVEN: ideal.gains} if nyquist else {}
        cases = {case: ideal.with_gains(gains) for case, gains in feedbacks.items()}
        if passivity:
            condition = observer_passivity(ideal, loop.observer.observer_gain)
    sensed = loop._replace(controller=controller._replace(gain=tuple(gain.tolist())))
    return LinearModel(
        model,
        a,
        b,
        np.sort_complex(np.linalg.eigvals(a)),
        gain,
        np.sort_complex(closed),
        margins(model, gain, controller.model_viscous) if stable else None,
        sensors_alone(sensed) if stable else None,
        condition,
        loop.observer.observer_gain,
        (loop.observer.friction, model) == (loop.plant.friction.parameters, loop.plant.model),
        cases,
    )


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
        The law, as :func:`furuta.friction_nonlinearity` takes it.

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
