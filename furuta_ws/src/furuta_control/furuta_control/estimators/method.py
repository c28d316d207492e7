"""The rig that every estimation method is designed for, and what is to be known of a method."""

from typing import NamedTuple

from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors


class NominalRig(NamedTuple):
    """Nominal model, sensors, time between measurements [s], and viscous friction [V s/rad]."""

    model: FurutaPendulum = FurutaPendulum()
    sensors: Sensors = Sensors()
    sample_time: float = 0.001
    viscous: float = 0.0


class Method(NamedTuple):
    """A method; one that does not cover the circle is for the pendulum near upright."""

    name: str
    meaning: str
    needs_applied_torque: bool = False
    covers_circle: bool = False
