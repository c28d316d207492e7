"""The unknowns of a fit: a vector for the optimiser, a model for the prediction.

Inertias are fitted as logarithms of β, γ, δ and of α − γ²/β, so that every vector is a pendulum.
An unknown that the data may say nothing of has a prior, its mean and spread, as weak as an
engineer's expectation is: friction no larger than needed, a base nearly level.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from furuta_identification.shooting.rig_model import NO_RIPPLE, RigModel
from furuta_model.friction.parameters import LuGre
from furuta_model.pendulum import FurutaPendulum


class Unknown(NamedTuple):
    """One unknown: its unit, allowed range, prior mean and spread, and a typical size."""

    name: str
    unit: str
    low: float
    high: float
    mean: float
    spread: float
    size: float


_FREE = (0.0, math.inf)
_BRISTLE = LuGre()


def _positive(name: str, unit: str, mean: float = 0.0, spread: float = math.inf) -> Unknown:
    """An unknown that is fitted as its logarithm."""
    return Unknown(name, unit, -20.0, 15.0, mean, spread, 1.0)


UNKNOWNS = (
    _positive("arm_inertia", "V s²/rad"),
    _positive("beta", "V s²/rad"),
    _positive("gamma", "V s²/rad"),
    _positive("delta", "V/rad"),
    Unknown("viscous", "V s/rad", -10.0, 100.0, *_FREE, 0.01),
    Unknown("coulomb", "V", 0.0, 100.0, 0.0, 0.1, 0.1),
    Unknown("asymmetry", "", -0.95, 0.95, 0.0, 0.2, 0.1),
    Unknown("pendulum_viscous", "V s/rad", -10.0, 100.0, *_FREE, 1e-3),
    Unknown("pendulum_coulomb", "V", -10.0, 100.0, 0.0, 0.02, 1e-3),
    Unknown("delay", "s", -0.05, 0.05, 0.0, 0.005, 1e-3),
    Unknown("lag", "s", 0.0, 0.05, 0.0, 0.01, 1e-3),
    Unknown("tilt_x", "rad", -0.3, 0.3, 0.0, 0.05, 0.01),
    Unknown("tilt_y", "rad", -0.3, 0.3, 0.0, 0.05, 0.01),
    Unknown("unbalance_cos", "V", -10.0, 10.0, 0.0, 0.02, 0.01),
    Unknown("unbalance_sin", "V", -10.0, 10.0, 0.0, 0.02, 0.01),
    Unknown("zero", "rad", -0.5, 0.5, 0.0, 0.1, 0.01),
    Unknown("ripple_order", "1/turn", 0.0, 1000.0, *_FREE, 1.0),
    Unknown("ripple_cos", "V", -10.0, 10.0, 0.0, 0.1, 0.01),
    Unknown("ripple_sin", "V", -10.0, 10.0, 0.0, 0.1, 0.01),
    Unknown("alpha1", "V", 0.0, 100.0, 0.0, 0.02, 0.01),
    _positive("stribeck_velocity", "rad/s", math.log(_BRISTLE.stribeck_velocity), 1.0),
    _positive("sigma0", "V/rad", math.log(_BRISTLE.sigma0), 1.0),
    _positive("sigma1", "V s/rad", math.log(_BRISTLE.sigma1), 1.0),
)
BY_NAME = {each.name: each for each in UNKNOWNS}
BODY = ("arm_inertia", "beta", "gamma", "delta")
FRICTION = ("viscous", "coulomb", "asymmetry", "pendulum_viscous", "pendulum_coulomb")
TIMING = ("delay", "lag")
SETUP = ("tilt_x", "tilt_y", "unbalance_cos", "unbalance_sin", "zero")
RIPPLE = ("ripple_cos", "ripple_sin")
LUGRE = ("alpha1", "stribeck_velocity", "sigma0", "sigma1")
# How far a logarithm may go from where it starts in one fit: a factor of 20.
REACH = 3.0
LOGARITHMIC = (*BODY, "stribeck_velocity", "sigma0", "sigma1")


@dataclass(frozen=True)
class Guess:
    """Values of all unknowns by their place in :data:`UNKNOWNS`, as the optimiser has them."""

    values: tuple[float, ...]

    @classmethod
    def of(cls, **given: float) -> Guess:
        """From plain values; what is not given is at its prior mean."""
        return cls(
            tuple(
                (math.log(given[each.name]) if each.name in LOGARITHMIC else given[each.name])
                if each.name in given
                else each.mean
                for each in UNKNOWNS
            )
        )

    def __getitem__(self, name: str) -> float:
        """The plain value of an unknown."""
        value = self.values[PLACE[name]]
        return math.exp(value) if name in LOGARITHMIC else value

    def vector(self, names: Sequence[str]) -> np.ndarray:
        """The optimiser's vector of some unknowns."""
        return np.array([self.values[PLACE[name]] for name in names])

    def changed(self, names: Sequence[str], vector: Sequence[float] | np.ndarray) -> Guess:
        """The same with some unknowns at other values, as the optimiser has them."""
        values = list(self.values)
        for name, value in zip(names, vector, strict=True):
            values[PLACE[name]] = float(value)
        return Guess(tuple(values))

    @property
    def body(self) -> FurutaPendulum:
        """The rigid body."""
        beta, gamma = self["beta"], self["gamma"]
        return FurutaPendulum(
            self["arm_inertia"] + gamma * gamma / beta, beta, gamma, self["delta"]
        )

    @property
    def friction(self) -> LuGre:
        """The arm's friction."""
        return LuGre(
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
        """The model that these values make."""
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


PLACE = {each.name: place for place, each in enumerate(UNKNOWNS)}


def bounds(guess: Guess, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest vector of some unknowns; logarithms stay within reach of ``guess``."""
    each = [BY_NAME[name] for name in names]
    low, high = np.array([u.low for u in each]), np.array([u.high for u in each])
    near = np.array([REACH if name in LOGARITHMIC else np.inf for name in names])
    vector = guess.vector(names)
    return np.maximum(low, vector - near), np.minimum(high, vector + near)
