"""Rigs of which only ranges are known: each parameter is anywhere in its range.

Estimator, friction observer and controller keep their nominal values. Rig k of a seed is the same
in a study of any size; its sensors have noise of their own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import count
from typing import NamedTuple

import numpy as np

from furuta_analysis.simulation.closed_loop import Loop
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError, declared
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.parameters import PlantParameters

# Parameters of the plant that can be uncertain.
FRICTION = tuple(Friction._fields)
MODEL = tuple(FurutaPendulum._fields)
_ALLOWED = {each.name: each.about for kind in (Friction, FurutaPendulum) for each in declared(kind)}
# Rigs that are drawn together.
_DRAWN = 1024


class UncertainRigs(NamedTuple):
    """A nominal loop and the range (low, high) of each uncertain parameter of its plant."""

    nominal: Loop
    ranges: dict[str, tuple[float, float]]

    def check(self) -> None:
        """Reject ranges beyond what the parameters may be."""
        for name, (low, high) in self.ranges.items():
            about = _ALLOWED[name]
            if low < about.low or high > about.high:
                raise ParameterError(
                    f"{name} must be {about.low:g} to {about.high:g}, given {low:g} to {high:g}"
                )

    def plant(self, values: Mapping[str, float], seed: int) -> PlantParameters:
        """The plant with some parameters replaced."""
        nominal = self.nominal.plant
        model = nominal.model._replace(**{n: values[n] for n in MODEL if n in values})
        friction = nominal.friction.parameters._replace(
            **{n: values[n] for n in FRICTION if n in values}
        )
        plant = nominal._replace(
            model=model, friction=nominal.friction._replace(parameters=friction), seed=seed
        )
        model.check()
        plant.check()
        return plant

    def loop_at(self, point: np.ndarray, seed: int) -> Loop:
        """The loop with the rig at a point of the unit cube."""
        values = {
            name: low + float(x) * (high - low)
            for (name, (low, high)), x in zip(self.ranges.items(), point, strict=True)
        }
        return self.nominal._replace(plant=self.plant(values, seed))

    def points(self, seed: int) -> Iterator[np.ndarray]:
        """Points of the unit cube without end."""
        generator = np.random.default_rng(seed)
        while True:
            yield from generator.random((_DRAWN, len(self.ranges)))

    def loops(self, rigs: int, seed: int) -> Iterator[Loop]:
        """The first ``rigs`` rigs of a ``seed``."""
        for number, point in zip(range(rigs), self.points(seed), strict=False):
            yield self.loop_at(point, self.nominal.plant.seed + number)

    def loops_at(self, points: np.ndarray) -> Iterator[Loop]:
        """The rigs at ``points`` (n, parameters), all with the noise of the nominal rig."""
        for point, _ in zip(points, count(), strict=False):
            yield self.loop_at(point, self.nominal.plant.seed)


def relative_ranges(
    plant: PlantParameters, friction_error: float, model_error: float
) -> dict[str, tuple[float, float]]:
    """Ranges of ± a relative error about the nominal values that are not zero."""
    errors = dict.fromkeys(FRICTION, friction_error) | dict.fromkeys(MODEL, model_error)
    nominal = plant.friction.parameters._asdict() | plant.model._asdict()
    return {
        name: (nominal[name] * (1.0 - error), nominal[name] * (1.0 + error))
        for name, error in errors.items()
        if nominal[name] != 0.0 and error > 0.0
    }
