"""Values of all unknown parameters: a vector for the optimiser, a model for the simulation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from furuta_identification.shooting.rig_model import RigModel
from furuta_identification.shooting.unknowns import (
    LOGARITHMIC,
    UNKNOWNS,
    is_zero,
    unknown,
    wave_names,
    wave_order,
    zero_name,
)
from furuta_model.friction.parameters import Friction
from furuta_model.parts.motion import PendulumFriction
from furuta_model.parts.tilt import Tilt
from furuta_model.pendulum import FurutaPendulum

# How far a logarithm may move from its starting value in one fit: a factor of 20.
LARGEST_LOG_CHANGE = 3.0


@dataclass(frozen=True)
class ParameterValues:
    """One value per unknown, by name, in the coordinates of the optimiser."""

    coordinates: Mapping[str, float]

    @classmethod
    def of(cls, **given: float) -> ParameterValues:
        """From physical values; all others are at the mean of their prior, without a ceiling."""
        coordinates = {about.name: about.mean for about in UNKNOWNS} | {"ceiling": math.inf}
        for name, value in given.items():
            coordinates[name] = math.log(value) if name in LOGARITHMIC else value
        return cls(coordinates)

    def __getitem__(self, name: str) -> float:
        """The physical value of an unknown."""
        value = self.coordinates[name]
        return math.exp(value) if name in LOGARITHMIC else value

    def vector(self, names: Sequence[str]) -> np.ndarray:
        """The optimiser's vector of some unknowns."""
        return np.array([self.coordinates[name] for name in names])

    def changed(
        self, names: Sequence[str], vector: Sequence[float] | np.ndarray
    ) -> ParameterValues:
        """With other values of some unknowns, in the optimiser's coordinates."""
        changes = {name: float(value) for name, value in zip(names, vector, strict=True)}
        return ParameterValues({**self.coordinates, **changes})

    def zero(self, number: int) -> float:
        """The zero [rad] of a recording by its number; a single recording's is just `zero`."""
        return self.coordinates.get(zero_name(number), self.coordinates["zero"])

    def with_zero(self, zero: float) -> ParameterValues:
        """With the same zero [rad] for every recording."""
        rest = {name: value for name, value in self.coordinates.items() if not is_zero(name)}
        return ParameterValues({**rest, "zero": zero})

    @property
    def wave_orders(self) -> list[int]:
        """Orders of the torque's waves, ascending."""
        orders = {wave_order(name) for name in self.coordinates}
        return sorted(order for order in orders if order is not None)

    @property
    def waves(self) -> np.ndarray:
        """Order, cosine and sine amplitude [V] of each wave of the torque (k, 3)."""
        rows = [(o, *(self[name] for name in wave_names(o))) for o in self.wave_orders]
        return np.array([row for row in rows if row[1] or row[2]], dtype=float).reshape(-1, 3)

    @property
    def body(self) -> FurutaPendulum:
        """The rigid body."""
        beta, gamma = self["beta"], self["gamma"]
        return FurutaPendulum(
            self["arm_inertia"] + gamma * gamma / beta, beta, gamma, self["delta"]
        )

    @property
    def friction(self) -> Friction:
        """The arm's friction."""
        return Friction(
            sigma0=self["sigma0"],
            sigma1=self["sigma1"],
            alpha0=self["coulomb"],
            alpha1=self["alpha1"],
            stribeck_velocity=self["stribeck_velocity"],
            viscous=self["viscous"],
            asymmetry=self["asymmetry"],
        )

    @property
    def model(self) -> RigModel:
        """The rig model with these values."""
        return RigModel(
            self.body,
            self.friction,
            PendulumFriction(self["pendulum_viscous"], self["pendulum_coulomb"]),
            Tilt(self["tilt_x"], self["tilt_y"]),
            self.waves,
            self["load"],
        )


def bounds(start: ParameterValues, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest vector of some unknowns in a fit from ``start``."""
    unknowns = [unknown(name) for name in names]
    low, high = np.array([u.low for u in unknowns]), np.array([u.high for u in unknowns])
    reach = np.array([LARGEST_LOG_CHANGE if name in LOGARITHMIC else np.inf for name in names])
    vector = start.vector(names)
    return np.maximum(low, vector - reach), np.minimum(high, vector + reach)
