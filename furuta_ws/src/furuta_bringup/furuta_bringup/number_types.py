"""Type of numeric options that click's own ranges do not cover."""

import math
from typing import Any

import click


class FiniteRange(click.FloatRange):
    """A range of finite numbers: unlike click's own it rejects NaN."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number."""
        try:
            float(value)
        except ValueError:
            self.fail(f"{value!r} is not a number; give it without a unit.", param, ctx)
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number

    def _describe_range(self) -> str:  # click's own says "x<=None" of a range without ends
        return super()._describe_range() if self.min != self.max else ""
