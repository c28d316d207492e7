"""Options that the verbs of ``furuta hw`` share."""

from __future__ import annotations

from collections.abc import Callable
from math import isnan
from typing import Any, TypeVar

import click

Function = TypeVar("Function", bound=Callable[..., Any])


class NumberRange(click.FloatRange):
    """A range of numbers; click's own lets NaN pass."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Convert text to a number within the range."""
        number = float(super().convert(value, param, ctx))
        if isnan(number):
            self.fail(f"{value} is not a number.", param, ctx)
        return number


def rig_options(function: Function) -> Function:
    """Add ``--port`` and ``--rig``."""
    function = click.option(
        "--rig", "name", default="paper", show_default=True, metavar="NAME|FILE", help="The rig."
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
        type=NumberRange(0.0, 1e3, min_open=True),
        default=2.0,
        show_default=True,
        help="Largest voltage [V].",
    )(function)
    return click.option(
        "--arm-range",
        "--travel",  # the earlier name
        "arm_range",
        type=NumberRange(0.01, 1e6),
        default=3.0,
        show_default=True,
        help="Stop when the arm is further than this from its start, to either side [rad].",
    )(function)


def seconds_option(default: float, text: str) -> Callable[[Function], Function]:
    """Add ``--seconds`` with its default [s] and help text."""
    return click.option(
        "--seconds",
        type=NumberRange(0.0, 3600.0, min_open=True),
        default=default,
        show_default=True,
        help=text,
    )
