"""Options of the analysis verbs, and the ideal loop that they describe."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from furuta.limit_cycles.ideal_loop import IdealLoop
from furuta.studies.parameter_range import GAINS
from furuta_model.friction.laws import analysed_law
from furuta_model.parameters import ParameterError
from furuta_model.transfer import checked_feedback, transfer
from furuta_sim.settings.parameter_names import parameters_named
from furuta_sim.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import Loop


def ideal_loop_of(
    loop: Loop, law: str | None, feedback: tuple[float, float, float, float] | None, linear: bool
) -> IdealLoop:
    """The ideal loop with the plant of ``loop``, another law and feedback u = l·x if given.

    Raises:
        ParameterError: The law has no limit cycles that can be analysed.
    """
    l1, l2, l3, l4 = feedback or (-each for each in loop.controller.feedback_gain)
    friction = loop.plant.friction
    analysed = analysed_law(law or friction.law, friction.parameters)
    return IdealLoop(loop.plant.model, analysed, l1, l2, l3, l4, linear)


class AnalysisOptions(NamedTuple):
    """Parameter files, assignments, friction law and feedback u = l·x of an analysis.

    Without a law it is the plant's, without a feedback the controller's.
    """

    files: tuple[Path, ...]
    assignments: tuple[str, ...]
    law: str | None
    feedback: tuple[float, float, float, float] | None
    linear: bool = False

    def ideal_loop(self, values: dict[str, float] | None = None) -> IdealLoop:
        """The ideal loop with further values of parameters or of the gains l1 to l4."""
        values = values or {}
        named = [f"{name}={float(value)!r}" for name, value in values.items() if name not in GAINS]
        configured = loop(load_settings(self.files, [*self.assignments, *named]))
        gains = list(self.feedback or [-each for each in configured.controller.feedback_gain])
        for name, value in values.items():
            if name in GAINS:
                gains[GAINS.index(name)] = value
        l1, l2, l3, l4 = gains
        return ideal_loop_of(configured, self.law, (l1, l2, l3, l4), self.linear)

    def checked_loop(self) -> IdealLoop:
        """The ideal loop, if its feedback is finite and not zero."""
        ideal = self.ideal_loop()
        checked_feedback(ideal.gains)
        return ideal

    def value(self, name: str) -> float | None:
        """The value of a parameter or gain in the settings, None if nodes have different values."""
        if name in GAINS:
            return float(getattr(self.ideal_loop(), name))
        settings = load_settings(self.files, self.assignments)
        found = {
            settings[node].get(each.name, each.default) for node, each in parameters_named(name)
        }
        return float(found.pop()) if len(found) == 1 else None


def require_stabilising(ideal: IdealLoop) -> None:
    """Reject a feedback whose loop is unstable without friction."""
    poles = transfer(ideal.body, ideal.gains).poles
    worst = poles[np.argmax(poles.real)]
    if worst.real > 1e-6:
        raise ParameterError(
            f"the feedback does not stabilise the pendulum even without friction: pole at "
            f"{worst.real:.4g}{worst.imag:+.4g}j 1/s"
        )
