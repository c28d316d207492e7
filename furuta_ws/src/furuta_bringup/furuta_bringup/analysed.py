"""What the verbs on G(s) and describing functions analyse: model, feedback and friction law."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from furuta_analysis.transfer import checked_feedback
from furuta_control.controller import state_feedback
from furuta_model.friction_laws import LAWS, FrictionLaw
from furuta_model.pendulum import FurutaPendulum

from .settings import gather, loop


class Analysed(NamedTuple):
    """The plant's true model, u = l·x with l (4,) [V/x], and the plant's friction."""

    pendulum: FurutaPendulum
    feedback: tuple[float, float, float, float]
    law: FrictionLaw


def analysed(
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    feedback: tuple[float, float, float, float] | None,
    law: str,
) -> Analysed:
    """What the options say, the controller's gain with its sign turned where no feedback is."""
    parameters = loop(gather(files, assignments))
    if feedback is None:
        l1, l2, l3, l4 = state_feedback(parameters.controller)[:4]
        feedback = (-l1, -l2, -l3, -l4)
    plant = parameters.plant
    return Analysed(
        plant.model, checked_feedback(feedback), FrictionLaw(LAWS.index(law), plant.friction)
    )
