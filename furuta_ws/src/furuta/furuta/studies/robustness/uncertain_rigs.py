"""Rigs that are known only roughly: by ranges of parameters, or by the uncertainty of a rig file.

A parameter with a range is anywhere in it. What a rig file states as uncertain has a normal
distribution with the covariance of the file (:mod:`furuta_hw.rigs.uncertainty`) about the nominal
values.
Estimator, friction observer and controller keep their nominal values. Rig k of a seed is the same
in a study of any size; its sensors have noise of their own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import CERTAIN, Uncertainty, changed_rig, values_of
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError, declared
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop

# Parameters of the plant that can have a range.
FRICTION = tuple(Friction._fields)
MODEL = tuple(FurutaPendulum._fields)
_ALLOWED = {each.name: each.about for kind in (Friction, FurutaPendulum) for each in declared(kind)}
# Rigs that are drawn together.
_DRAWN = 1024


class UncertainRigs(NamedTuple):
    """A nominal loop, ranges (low, high) of parameters of its plant, and a rig's uncertainty.

    ``rig`` is the rig file's, for what a plant does not state. A range replaces what the rig's
    uncertainty says about the same parameter. A point, which determines a rig, is an array: the
    change of each uncertain coordinate, then where in its range each parameter is (0 to 1).
    """

    nominal: Loop
    ranges: dict[str, tuple[float, float]]
    rig: Rig = Rig()
    uncertainty: Uncertainty = CERTAIN

    def check(self) -> None:
        """Reject ranges beyond what the parameters may be, and rigs without uncertainty."""
        if not self.names:
            raise ParameterError("no parameter is uncertain: give a range, NAME=LOW:HIGH")
        for name, (low, high) in self.ranges.items():
            about = _ALLOWED[name]
            if low < about.low or high > about.high:
                raise ParameterError(
                    f"{name} must be {about.low:g} to {about.high:g}, given {low:g} to {high:g}"
                )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the uncertain values."""
        return tuple(dict.fromkeys((*self.uncertainty.names, *self.ranges)))

    def points(self, seed: int) -> Iterator[np.ndarray]:
        """Random points without end."""
        generator = np.random.default_rng(seed)
        while True:
            changes = self.uncertainty.draws(_DRAWN, generator)
            yield from np.hstack((changes, generator.random((_DRAWN, len(self.ranges)))))

    def values_at(self, point: np.ndarray) -> dict[str, float]:
        """The uncertain values of the rig at a point, by name."""
        drawn = values_of(self._changed(point)) if self.uncertainty.names else {}
        given = drawn | self._in_ranges(point)
        return {name: given[name] for name in self.names}

    def loop_at(self, point: np.ndarray, seed: int) -> Loop:
        """The loop with the rig at a point; ``seed`` is that of its noise."""
        plant = self.nominal.plant
        if self.uncertainty.names:
            plant = _with_rig(plant, self._changed(point))
        plant = _with_values(plant, self._in_ranges(point))._replace(seed=seed)
        plant.model.check()
        plant.check()
        return self.nominal._replace(plant=plant)

    def loops(self, rigs: int, seed: int) -> Iterator[Loop]:
        """The first ``rigs`` rigs of a ``seed``."""
        for number, point in zip(range(rigs), self.points(seed), strict=False):
            yield self.loop_at(point, self.nominal.plant.seed + number)

    def loops_at(self, points: np.ndarray) -> Iterator[Loop]:
        """The rigs at ``points`` (n, coordinates), all with the noise of the nominal rig."""
        for point in points:
            yield self.loop_at(point, self.nominal.plant.seed)

    def _changed(self, point: np.ndarray) -> Rig:
        """The rig with its uncertain coordinates changed, about the plant's nominal values."""
        plant, names = self.nominal.plant, self.uncertainty.names
        nominal = self.rig._replace(
            model=plant.model,
            friction=plant.friction.parameters,
            pendulum_friction=plant.pendulum_friction,
            tilt=plant.tilt,
        )
        return changed_rig(nominal, names, point[: len(names)])

    def _in_ranges(self, point: np.ndarray) -> dict[str, float]:
        within = point[len(self.uncertainty.names) :]
        return {
            name: low + float(x) * (high - low)
            for (name, (low, high)), x in zip(self.ranges.items(), within, strict=True)
        }


def _with_rig(plant: PlantParameters, rig: Rig) -> PlantParameters:
    """The plant with what can be uncertain in a rig file."""
    return plant._replace(
        model=rig.model,
        friction=plant.friction._replace(parameters=rig.friction),
        pendulum_friction=rig.pendulum_friction,
        drive=plant.drive._replace(delay=rig.drive_dynamics.delay),
        tilt=rig.tilt,
    )


def _with_values(plant: PlantParameters, values: Mapping[str, float]) -> PlantParameters:
    """The plant with some parameters replaced."""
    friction = plant.friction.parameters._replace(**_named(values, FRICTION))
    return plant._replace(
        model=plant.model._replace(**_named(values, MODEL)),
        friction=plant.friction._replace(parameters=friction),
    )


def _named(values: Mapping[str, float], names: tuple[str, ...]) -> dict[str, Any]:
    return {name: values[name] for name in names if name in values}


def relative_ranges(
    plant: PlantParameters, friction_error: float, model_error: float
) -> dict[str, tuple[float, float]]:
    """Ranges of ± a relative error about the nominal values that are not zero."""
    errors = dict.fromkeys(FRICTION, friction_error) | dict.fromkeys(MODEL, model_error)
    nominal = plant.friction.parameters._asdict() | plant.model._asdict()
    changes = {name: error * abs(nominal[name]) for name, error in errors.items()}
    return {
        name: (nominal[name] - change, nominal[name] + change)
        for name, change in changes.items()
        if change > 0.0
    }
