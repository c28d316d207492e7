"""The ideal loop that settings describe, and ranges of parameters on the command line."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from furuta_analysis.describing_functions.transfer import checked_feedback, transfer
from furuta_analysis.limit_cycles.ideal_loop import IdealLoop
from furuta_control.controller import state_feedback
from furuta_graph.parameter_names import parameters_named
from furuta_graph.settings import load_settings, loop
from furuta_model.friction_laws import LAWS, FrictionLaw
from furuta_model.parameters import ParameterError

GAINS = ("l1", "l2", "l3", "l4")
MOST_VALUES = 1000


class LoopOptions(NamedTuple):
    """What the options of an analysis verb say."""

    files: tuple[Path, ...]
    assignments: tuple[str, ...]
    law: str
    feedback: tuple[float, float, float, float] | None
    linear: bool = False

    def loop(self, values: dict[str, float] | None = None) -> IdealLoop:
        """The ideal loop with further values: parameters by name, or l1 to l4."""
        values = values or {}
        named = [f"{name}={float(value)!r}" for name, value in values.items() if name not in GAINS]
        made = loop(load_settings(self.files, [*self.assignments, *named]))
        gains = list(self.feedback or [-each for each in state_feedback(made.controller)[:4]])
        for name, value in values.items():
            if name in GAINS:
                gains[GAINS.index(name)] = value
        law = FrictionLaw(LAWS.index(self.law), made.plant.friction)
        l1, l2, l3, l4 = gains
        return IdealLoop(made.plant.model, law, l1, l2, l3, l4, self.linear)

    def checked_loop(self) -> IdealLoop:
        """The ideal loop, its feedback checked to be finite and not zero."""
        made = self.loop()
        checked_feedback(made.gains)
        return made

    def value(self, name: str) -> float | None:
        """What the settings say of a parameter or gain, None where its nodes disagree."""
        if name in GAINS:
            return float(getattr(self.loop(), name))
        settings = load_settings(self.files, self.assignments)
        found = {
            settings[node].get(each.name, each.default) for node, each in parameters_named(name)
        }
        return float(found.pop()) if len(found) == 1 else None


def require_stabilising(made: IdealLoop) -> None:
    """Refuse a feedback whose loop is unstable before friction has a say."""
    poles = transfer(made.body, (made.l1, made.l2, made.l3, made.l4)).poles
    worst = poles[np.argmax(poles.real)]
    if worst.real > 1e-6:
        raise ParameterError(
            f"the feedback does not stabilise the pendulum even without friction: pole at "
            f"{worst.real:.4g}{worst.imag:+.4g}j 1/s"
        )


def parse_range(text: str, default_count: int) -> tuple[str, np.ndarray]:
    """NAME=LOW:HIGH or NAME=LOW:HIGH:COUNT as name and values."""
    name, _, rest = text.partition("=")
    parts = rest.split(":")
    try:
        low, high = float(parts[0]), float(parts[1])
        count = int(parts[2]) if len(parts) > 2 else default_count
    except (ValueError, IndexError):
        raise ParameterError(f"expected NAME=LOW:HIGH[:COUNT], given {text!r}") from None
    if len(parts) > 3 or not (np.isfinite([low, high]).all() and low < high):
        raise ParameterError(f"{name}: needs finite LOW < HIGH, given {rest!r}")
    if not 2 <= count <= MOST_VALUES:
        raise ParameterError(f"{name}: COUNT must be 2 to {MOST_VALUES}, given {count}")
    check_name(name.strip())
    return name.strip(), np.linspace(low, high, count)


def check_name(name: str) -> None:
    """Refuse a name that is no parameter before anything is computed."""
    if name not in GAINS:
        parameters_named(name)
