"""Tilt of the base: gravity that is not parallel to the arm's axis.

A small tilt acts like a constant horizontal acceleration of the base, in units of gravity.
"""

from typing import Annotated, NamedTuple

from furuta_model.compiled import compiled
from furuta_model.parameters import About
from furuta_model.parts.pushes import Push


class Tilt(NamedTuple):
    """Components of the upward vertical in the plane of the arm."""

    x: Annotated[float, About("tilt of the base, along the arm at angle 0", "rad", -0.5, 0.5)] = 0.0
    y: Annotated[float, About("tilt of the base, across the arm at angle 0", "rad", -0.5, 0.5)] = (
        0.0
    )


@compiled
def with_tilt(push: Push, p: Tilt) -> Push:
    """The push with the tilt as an acceleration of the base."""
    return Push(push.arm, push.pendulum, push.base_x + p.x, push.base_y + p.y)
