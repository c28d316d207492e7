"""Options that the verbs of ``furuta hw`` share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

from furuta_bringup.number_types import FiniteRange

Function = TypeVar("Function", bound=Callable[..., Any])


def rig_options(function: Function) -> Function:
    """Add ``--port`` and ``--rig``."""
    function = click.option(
        "--rig", "name", default="paper", show_default=True, metavar="NAME|FILE", help="Rig file."
    )(function)
    return click.option(
        "--port",
        required=True,
        metavar="PORT",
        help="Port of the rig, or mock for an emulated rig.",
    )(function)


def drive_options(function: Function) -> Function:
    """Add ``--voltage`` and ``--arm-range``, the limits of verbs that drive."""
    function = click.option(
        "--voltage",
        type=FiniteRange(0.0, 1e3, min_open=True),
        default=2.0,
        show_default=True,
        help="Largest voltage [V].",
    )(function)
    return click.option(
        "--arm-range",
        "arm_range",
        type=FiniteRange(0.01, 1e6),
        default=3.0,
        show_default=True,
        help="Stop when the arm is further than this from its start, in either direction [rad].",
    )(function)


def seconds_option(default: float, text: str) -> Callable[[Function], Function]:
    """Add ``--seconds`` with its default [s] and help text."""
    return click.option(
        "--seconds",
        type=FiniteRange(0.0, 3600.0, min_open=True),
        default=default,
        show_default=True,
        help=text,
    )
