"""What every compensator is told, and what is to be known of one."""

from typing import NamedTuple

from furuta_model.friction.parameters import Friction


class Joint(NamedTuple):
    """What every compensator is told: friction, gain K [1/s] of (9), sample time [s]."""

    friction: Friction = Friction()
    observer_gain: float = 0.0
    sample_time: float = 0.0


class Compensator(NamedTuple):
    """A compensator: its title, and whether it needs the observed friction."""

    name: str
    title: str
    meaning: str
    needs_observed_friction: bool = False
