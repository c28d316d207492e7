"""Interface of a controller mode.

A mode is a file in this folder that defines a :class:`Mode` as ``PART``;
:mod:`furuta_control.control` lists the file.
"""

from collections.abc import Callable
from typing import Any, NamedTuple


class Mode(NamedTuple):
    """A mode.

    ``command`` (compiled) gives u [V], unsaturated, from the memory
    (:class:`furuta_control.control.ControllerMemory`), the state estimate (4 or more), the friction
    estimate [V] and the design (:class:`furuta_control.control.ControllerDesign`); NaN if the mode
    does not drive. Modes with ``feedback`` about upright keep what they remember; another mode
    forgets it.

    A mode may have ``parameters``, a ``memory``, a ``design`` and a ``reset``, as a compensator has
    (:class:`furuta_friction.compensator.Compensator`): from all ``ControllerParameters``, and found
    by its name in ``p.parts`` and ``memory.parts``.
    """

    name: str
    meaning: str
    command: Callable[..., float]
    feedback: bool = False
    parameters: Any = None
    inline: bool = False
    memory: Any = None
    design: Callable[[Any], Any] | None = None
    reset: Callable[[Any], None] | None = None
