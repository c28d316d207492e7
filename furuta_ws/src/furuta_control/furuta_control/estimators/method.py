"""Interface of an estimation method, and the rig that every method is designed for.

A method is a file in this folder that defines a :class:`Method` as ``PART``;
:mod:`furuta_control.estimation` lists the file.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors


class NominalRig(NamedTuple):
    """Nominal model, sensors, time between measurements [s], and viscous friction [V s/rad]."""

    model: FurutaPendulum = FurutaPendulum()
    sensors: Sensors = Sensors()
    sample_time: float = 0.001
    viscous: float = 0.0


@inlined
def nothing(memory: Any, measurement: np.ndarray, p: Any) -> None:
    """Begin without a step of the method's own."""


@inlined
def no_prediction(memory: Any, torque: float, p: Any, predicted: np.ndarray) -> None:
    """Leave the prediction at constant speeds."""


class Method(NamedTuple):
    """An estimation method.

    ``update`` (compiled) moves ``memory.estimate`` by one sample with a measurement (5,). ``begin``
    (compiled) gets the same arguments when the method starts from an estimate. ``predict``
    (compiled) improves the expected readings (5,) for the torque [V] that is applied meanwhile; by
    default they are those at constant speeds. ``needs_applied_torque``: of every measurement. A
    method that does not cover the circle is for the pendulum near upright.

    A method may have ``parameters``, a ``memory`` and a ``design``, as a compensator does
    (:class:`furuta_friction.compensator.Compensator`): from all ``EstimatorParameters``, and found
    by its name in ``p.parts`` and ``memory.parts``.
    """

    name: str
    meaning: str
    update: Callable[..., None]
    begin: Callable[..., None] = nothing
    predict: Callable[..., None] = no_prediction
    observes_friction: bool = False
    needs_applied_torque: bool = False
    covers_circle: bool = False
    parameters: Any = None
    inline: bool = False
    memory: Any = None
    design: Callable[[Any], Any] | None = None
