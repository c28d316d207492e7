"""Options that verbs share, and their output."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from furuta_model.friction.laws import LAWS

Function = TypeVar("Function", bound=Callable[..., Any])


def model_options(function: Function) -> Function:
    """``--params FILE`` and ``--set NAME=VALUE``, both repeatable."""
    function = click.option(
        "--set",
        "assignments",
        multiple=True,
        metavar="NAME=VALUE",
        help="Set a parameter: alpha0=0.3 wherever it occurs, or plant.friction.alpha0=0.3.",
    )(function)
    return click.option(
        "--params",
        "files",
        multiple=True,
        type=click.Path(exists=False, path_type=Path),
        metavar="FILE",
        help="ROS parameter file.",
    )(function)


def ideal_options(function: Function) -> Function:
    """``--law`` and ``--feedback`` of the verbs on the ideal loop."""
    function = click.option(
        "--law", type=click.Choice(LAWS), default="lugre", show_default=True, help="Friction law."
    )(function)
    return feedback_option(function)


feedback_option = click.option(
    "--feedback",
    nargs=4,
    type=float,
    metavar="L1 L2 L3 L4",
    help="u = l·x; default: the controller's gain.",
)

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object and nothing else."
)


def print_json(result: dict[str, Any]) -> None:
    """One JSON object on standard output; NaN, which JSON lacks, becomes null."""
    print(json.dumps(_finite(result)))


def _finite(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(each) for each in value]
    return value
