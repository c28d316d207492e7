"""Interface of a friction compensator.

A compensator is a file in ``compensators/`` that defines a :class:`Compensator` as ``PART``;
:mod:`furuta_friction.compensation` lists the file.
"""

from collections.abc import Callable
from typing import Any, NamedTuple


class Compensator(NamedTuple):
    """A compensator.

    ``estimate`` (compiled) gives F̂ [V] from the memory
    (:class:`furuta_friction.compensation.CompensationMemory`), the state estimate (5,) and the
    design (:class:`furuta_friction.compensation.CompensationDesign`). The observed friction, the
    fifth number of the state estimate, is NaN if the estimator does not observe friction. With
    ``runs_observer`` the function moves the observer (9) itself; otherwise it runs idle beside it.
    |F̂| is at most ``largest_factor`` times the highest level of the friction parameters.

    A compensator may have ``parameters`` (a named tuple; with ``inline`` their names do not begin
    with that of the compensator), a ``memory`` (a dataclass) and a ``design``: from all
    ``ObserverParameters``, what it computes with, by default its parameters. ``estimate`` finds
    memory and design by the compensator's name, in ``memory.parts`` and ``p.parts``. ``reset``
    (compiled) prepares the memory for a rig that has been put back.
    """

    name: str
    meaning: str
    estimate: Callable[..., float]
    needs_observed_friction: bool = False
    runs_observer: bool = False
    largest_factor: float = 1.0
    parameters: Any = None
    inline: bool = False
    memory: Any = None
    design: Callable[[Any], Any] | None = None
    reset: Callable[[Any], None] | None = None
