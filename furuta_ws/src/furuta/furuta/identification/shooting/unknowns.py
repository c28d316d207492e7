"""The unknown parameters of the model: units, ranges, priors, values.

Inertias are fitted as logarithms of β, γ, δ and of α − γ²/β, so that every vector is a possible
pendulum. Parameters that the data may not determine have a prior, a mean and a standard deviation.
It is as weak as an engineer's expectation: friction no larger than needed, a base nearly level.
Friction is never negative.

Two kinds have numbers: the waves of the motor's torque over the arm's turn (:func:`wave`), and the
zero of the pendulum's angle in each of several recordings, ``("zero", number)``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from furuta.identification.shooting.prediction import RigModel
from furuta.identification.unknowns import Key, Unknown, Unknowns, Values, field_of
from furuta_model.friction.parameters import Friction
from furuta_model.parts.disturbances import Tilt
from furuta_model.parts.motion import PendulumFriction
from furuta_model.pendulum import FurutaPendulum

# How far a logarithm may move from its starting value in one fit: a factor of 20.
LARGEST_LOG_CHANGE = 3.0


class Range(NamedTuple):
    """Allowed range of an unknown parameter, mean and standard deviation of its prior.

    ``step`` is that of finite differences.
    """

    low: float
    high: float
    mean: float = 0.0
    spread: float = math.inf
    step: float = 1e-6


_POSITIVE = Range(-20.0, 15.0)  # the logarithm
_BRISTLE = Friction()
UNKNOWNS = {
    "arm_inertia": _POSITIVE,  # V s²/rad, as β and γ
    "beta": _POSITIVE,
    "gamma": _POSITIVE,
    "delta": _POSITIVE,  # V/rad
    "viscous": Range(0.0, 100.0),  # V s/rad
    "coulomb": Range(0.0, 100.0, 0.0, 0.1),  # V
    "asymmetry": Range(-0.95, 0.95, 0.0, 0.2),
    "pendulum_viscous": Range(0.0, 100.0),  # V s/rad
    "pendulum_coulomb": Range(0.0, 100.0, 0.0, 0.02),  # V
    # A command that passes a step of the integration moves the prediction by a stair.
    "delay": Range(-0.05, 0.05, 0.0, 0.005, step=1e-4),  # s
    "lag": Range(0.0, 0.05, 0.0, 0.01),  # s
    "tilt_x": Range(-0.3, 0.3, 0.0, 0.05),  # rad
    "tilt_y": Range(-0.3, 0.3, 0.0, 0.05),  # rad
    "zero": Range(-0.5, 0.5, 0.0, 0.1),  # rad
    "ceiling": _POSITIVE,  # V
    "alpha1": Range(0.0, 100.0, 0.0, 0.02),  # V
    "stribeck_velocity": Range(-20.0, 15.0, math.log(_BRISTLE.stribeck_velocity), 1.0),  # rad/s
    "sigma0": Range(-20.0, 15.0, math.log(_BRISTLE.sigma0), 1.0),  # V/rad
    "sigma1": Range(-20.0, 15.0, math.log(_BRISTLE.sigma1), 1.0),  # V s/rad
}
BODY = ("arm_inertia", "beta", "gamma", "delta")
FRICTION = ("viscous", "coulomb", "asymmetry", "pendulum_viscous", "pendulum_coulomb")
SETUP = ("delay", "lag", "tilt_x", "tilt_y")
LUGRE = ("alpha1", "stribeck_velocity", "sigma0", "sigma1")
# Largest standard deviation of the logarithm of a value that is assumed: a factor of 2. The priors
# are weaker, because the data narrow them.
LARGEST_ASSUMED = 0.7
LOGARITHMIC = (*BODY, "stribeck_velocity", "sigma0", "sigma1", "ceiling")


def range_of(key: Key) -> Range:
    """Range and prior of an unknown."""
    if field_of(key) in ("cos", "sin"):
        # An unbalanced arm (order 1) on a base that is nearly level has little torque.
        return Range(-10.0, 10.0, 0.0, 0.02 if key[1] == 1 else 0.1)
    return UNKNOWNS[field_of(key)]


def assumed_spread(name: str) -> float:
    """Standard deviation of an unknown that is assumed at the mean of its prior."""
    return min(UNKNOWNS[name].spread, LARGEST_ASSUMED)


def wave(order: int) -> tuple[Key, Key]:
    """The amplitudes of the torque's cosine and sine wave with ``order`` waves per turn."""
    return ("cos", order), ("sin", order)


@dataclass(frozen=True)
class ParameterValues:
    """One value per unknown, by name, in the coordinates of the optimiser."""

    coordinates: Values

    @classmethod
    def of(cls, **given: float) -> ParameterValues:
        """From physical values; all others are at the mean of their prior, without a ceiling."""
        coordinates: dict[Key, float] = {name: about.mean for name, about in UNKNOWNS.items()}
        coordinates |= {"ceiling": math.inf}
        for name, value in given.items():
            coordinates[name] = math.log(value) if name in LOGARITHMIC else value
        return cls(coordinates)

    def __getitem__(self, key: Key) -> float:
        """The physical value of an unknown."""
        value = self.coordinates[key]
        return math.exp(value) if key in LOGARITHMIC else value

    def vector(self, keys: Sequence[Key]) -> np.ndarray:
        """The optimiser's vector of some unknowns."""
        return np.array([self.coordinates[key] for key in keys])

    def changed(self, keys: Sequence[Key], vector: Sequence[float] | np.ndarray) -> ParameterValues:
        """With other values of some unknowns, in the optimiser's coordinates."""
        changes = {key: float(value) for key, value in zip(keys, vector, strict=True)}
        return ParameterValues({**self.coordinates, **changes})

    def zero(self, number: int) -> float:
        """The zero [rad] of a recording by its number; a single recording's is just `zero`."""
        return self.coordinates.get(("zero", number), self.coordinates["zero"])

    def with_zero(self, zero: float) -> ParameterValues:
        """With the same zero [rad] for every recording."""
        rest = {k: value for k, value in self.coordinates.items() if field_of(k) != "zero"}
        return ParameterValues({**rest, "zero": zero})

    @property
    def wave_orders(self) -> list[int]:
        """Orders of the torque's waves, ascending."""
        return sorted(int(key[1]) for key in self.coordinates if field_of(key) == "cos")

    @property
    def waves(self) -> np.ndarray:
        """Order, cosine and sine amplitude [V] of each wave of the torque (k, 3)."""
        rows = [(order, *(self[key] for key in wave(order))) for order in self.wave_orders]
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
            self["delay"],
            self["lag"],
            self["ceiling"],
        )


def unknowns_of(keys: Sequence[Key], start: ParameterValues) -> Unknowns:
    """The unknowns of a fit from a start, about which a logarithm stays."""
    return Unknowns(_unknown(key, start.coordinates[key]) for key in keys)


def _unknown(key: Key, value: float) -> Unknown:
    low, high, mean, spread, step = range_of(key)
    reach = LARGEST_LOG_CHANGE if key in LOGARITHMIC else math.inf
    low, high = max(low, value - reach), min(high, value + reach)
    return Unknown(key, low, high, mean, spread, step=step)
