"""Interface of a friction compensator.

A compensator is a file in ``compensators/`` that defines a :class:`Compensator`;
:mod:`furuta_friction.compensation` lists it.
"""

from collections.abc import Callable
from typing import NamedTuple


class Compensator(NamedTuple):
    """A compensator.

    ``estimate`` (compiled) gives F̂ [V] from the memory
    (:class:`furuta_friction.compensation.CompensationMemory`), the state estimate (5,) and the
    design (:class:`furuta_friction.compensation.CompensationDesign`). The observed friction, the
    fifth number of the state estimate, is NaN if the estimator does not observe friction. With
    ``runs_observer`` the function moves the observer (9) itself; otherwise it runs idle beside it.
    |F̂| is at most ``largest_factor`` times the highest level of the friction parameters.
    """

    name: str
    meaning: str
    estimate: Callable[..., float]
    needs_observed_friction: bool = False
    runs_observer: bool = False
    largest_factor: float = 1.0
