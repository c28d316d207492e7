"""What the verbs on G(s) and describing functions analyse: model, feedback and friction law."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from furuta_analysis.transfer import checked_feedback
from furuta_model.friction_laws import FrictionLaw
from furuta_model.pendulum import FurutaPendulum

from .ideal import Choice


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
    made = Choice(files, assignments, law, feedback).loop()
    gains = checked_feedback((made.l1, made.l2, made.l3, made.l4))
    return Analysed(made.body, gains, made.law)
