"""Options that say how uncertain the rigs of a study are."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import click
import numpy as np

from furuta.studies.robustness.uncertain_rigs import FRICTION, MODEL, UncertainRigs, relative_ranges
from furuta_bringup.number_types import FiniteRange
from furuta_bringup.options import parameter_options, rig_option
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import CERTAIN
from furuta_model.parameters import ParameterError
from furuta_sim.settings.rigs import find_uncertain_rig, rig_file
from furuta_sim.settings.settings import load_settings, loop

Function = TypeVar("Function", bound=Callable[..., Any])

# Relative errors of friction and pendulum of a rig whose uncertainty is not known.
ERROR, MODEL_ERROR = 0.3, 0.1
_RELATIVE = FiniteRange(0, 1, max_open=True)


class RigOptions(NamedTuple):
    """The nominal rig, its parameters, and its relative errors, None where they are not given."""

    rig: str
    files: tuple[Path, ...]
    assignments: tuple[str, ...]
    error: float | None
    model_error: float | None

    @property
    def all_files(self) -> tuple[Path, ...]:
        """The rig's file, if one is given, before the parameter files."""
        return (rig_file(self.rig), *self.files) if self.rig else self.files

    def uncertain_rigs(self, ranges: tuple[str, ...] = ()) -> UncertainRigs:
        """The rigs that the options and ``ranges`` NAME=LOW:HIGH describe.

        Without relative errors they are as uncertain as the rig's file says, if it does.
        """
        rig, uncertainty = find_uncertain_rig(self.rig) if self.rig else (Rig(), CERTAIN)
        nominal = loop(load_settings(self.all_files, self.assignments))
        given = {}
        if not uncertainty.names or (self.error, self.model_error) != (None, None):
            uncertainty = CERTAIN
            error = ERROR if self.error is None else self.error
            model_error = MODEL_ERROR if self.model_error is None else self.model_error
            given = relative_ranges(nominal.plant, error, model_error)
        given |= dict(parse_uncertain(each) for each in ranges)
        rigs = UncertainRigs(nominal, given, rig, uncertainty)
        rigs.check()
        return rigs


def uncertain_rig_options(function: Function) -> Callable[..., Any]:
    """``--rig``, ``--params``, ``--set``, ``--error`` and ``--model-error``, as ``rig_options``."""

    @wraps(function)
    def with_rigs(**given: Any) -> Any:
        named = {name: given.pop(name) for name in RigOptions._fields}
        return function(rig_options=RigOptions(**named), **given)

    wrapped: Any = rig_option(parameter_options(with_rigs))
    for name, about, default in (
        ("--model-error", "coefficient of the pendulum", MODEL_ERROR),
        ("--error", "friction parameter", ERROR),
    ):
        text = (
            f"Relative error of every {about} of the rigs. Default: as the file of --rig says, or "
            f"{default:g} if it states no uncertainty."
        )
        wrapped = click.option(name, type=_RELATIVE, help=text)(wrapped)
    made: Callable[..., Any] = wrapped
    return made


def parse_uncertain(text: str) -> tuple[str, tuple[float, float]]:
    """Name and range of NAME=LOW:HIGH."""
    name, _, rest = text.partition("=")
    names = (*FRICTION, *MODEL)
    if name not in names:
        raise ParameterError(f"uncertain can be {', '.join(names)}; given {text!r}")
    try:
        low, high = map(float, rest.split(":"))
    except ValueError:
        raise ParameterError(f"expected NAME=LOW:HIGH, given {text!r}") from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise ParameterError(f"{name}: needs finite LOW < HIGH, given {rest!r}")
    return name, (low, high)
