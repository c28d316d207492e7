"""Values of all unknown parameters: a vector for the optimiser, a model for the simulation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from furuta_identification.shooting.rig_model import NO_RIPPLE, RigModel
from furuta_identification.shooting.unknowns import BY_NAME, INDEX, LOGARITHMIC, UNKNOWNS
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum

# How far a logarithm may move from its starting value in one fit: a factor of 20.
LARGEST_LOG_CHANGE = 3.0


@dataclass(frozen=True)
class ParameterValues:
    """One value per unknown, in the order and in the coordinates of the optimiser."""

    coordinates: tuple[float, ...]

    @classmethod
    def of(cls, **given: float) -> ParameterValues:
        """From physical values; all others are at the mean of their prior."""
        return cls(
            tuple(
                (math.log(given[each.name]) if each.name in LOGARITHMIC else given[each.name])
                if each.name in given
                else each.mean
                for each in UNKNOWNS
            )
        )

    def __getitem__(self, name: str) -> float:
        """The physical value of an unknown."""
        value = self.coordinates[INDEX[name]]
        return math.exp(value) if name in LOGARITHMIC else value

    def vector(self, names: Sequence[str]) -> np.ndarray:
        """The optimiser's vector of some unknowns."""
        return np.array([self.coordinates[INDEX[name]] for name in names])

    def changed(
        self, names: Sequence[str], vector: Sequence[float] | np.ndarray
    ) -> ParameterValues:
        """With other values of some unknowns, in the optimiser's coordinates."""
        coordinates = list(self.coordinates)
        for name, value in zip(names, vector, strict=True):
            coordinates[INDEX[name]] = float(value)
        return ParameterValues(tuple(coordinates))

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
        waves = [
            (1.0, self["unbalance_cos"], self["unbalance_sin"]),
            (self["ripple_order"], self["ripple_cos"], self["ripple_sin"]),
        ]
        return RigModel(
            self.body,
            self.friction,
            self["pendulum_viscous"],
            self["pendulum_coulomb"],
            self["tilt_x"],
            self["tilt_y"],
            np.array([wave for wave in waves if wave[1] or wave[2]] or NO_RIPPLE),
        )


def bounds(start: ParameterValues, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest vector of some unknowns in a fit from ``start``."""
    unknowns = [BY_NAME[name] for name in names]
    low, high = np.array([u.low for u in unknowns]), np.array([u.high for u in unknowns])
    reach = np.array([LARGEST_LOG_CHANGE if name in LOGARITHMIC else np.inf for name in names])
    vector = start.vector(names)
    return np.maximum(low, vector - reach), np.minimum(high, vector + reach)
