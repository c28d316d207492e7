"""Interface of a controller mode.

A mode is a file in this folder that defines a :class:`Mode`; :mod:`furuta_control.control` lists
it.
"""

from collections.abc import Callable
from typing import NamedTuple


class Mode(NamedTuple):
    """A mode.

    ``command`` (compiled) gives u [V], unsaturated, from the memory
    (:class:`furuta_control.control.ControllerMemory`), the state estimate (4 or more), the friction
    estimate [V] and the design (:class:`furuta_control.control.ControllerDesign`); NaN if the mode
    does not drive. Modes with ``feedback`` about upright keep what they remember; another mode
    forgets it.
    """

    name: str
    meaning: str
    command: Callable[..., float]
    feedback: bool = False
