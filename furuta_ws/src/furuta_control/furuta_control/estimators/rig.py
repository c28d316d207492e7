"""Nominal rig, as every estimator uses it."""

from __future__ import annotations

from typing import NamedTuple

from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors


class NominalRig(NamedTuple):
    """Nominal model, sensors, time between measurements [s], and viscous friction [V s/rad]."""

    model: FurutaPendulum = FurutaPendulum()
    sensors: Sensors = Sensors()
    sample_time: float = 0.001
    viscous: float = 0.0
