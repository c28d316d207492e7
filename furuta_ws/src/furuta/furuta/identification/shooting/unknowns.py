"""The unknown parameters of the model: units, ranges, priors, values.

Inertias are fitted as logarithms of β, γ, δ and of α − γ²/β, so that every vector is a possible
pendulum. Parameters that the data may not determine have a prior, a mean and a standard deviation.
It is as weak as an engineer's expectation: friction no larger than needed, a base nearly level.
Friction is never negative.

Two kinds of unknowns are named when they are needed: the waves of the motor's torque over the arm's
turn (:func:`wave_names`) and the zero of the pendulum's angle in each of several recordings
(:func:`zero_name`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from furuta.identification.shooting.prediction import RigModel
from furuta_model.friction.parameters import Friction
from furuta_model.parts.disturbances import Tilt
from furuta_model.parts.motion import PendulumFriction
from furuta_model.pendulum import FurutaPendulum

# How far a logarithm may move from its starting value in one fit: a factor of 20.
LARGEST_LOG_CHANGE = 3.0


class Unknown(NamedTuple):
    """Allowed range of an unknown parameter, mean and standard deviation of its prior."""

    low: float
    high: float
    mean: float = 0.0
    spread: float = math.inf


_POSITIVE = Unknown(-20.0, 15.0)  # the logarithm
_BRISTLE = Friction()
UNKNOWNS = {
    "arm_inertia": _POSITIVE,  # V s²/rad, as β and γ
    "beta": _POSITIVE,
    "gamma": _POSITIVE,
    "delta": _POSITIVE,  # V/rad
    "viscous": Unknown(0.0, 100.0),  # V s/rad
    "coulomb": Unknown(0.0, 100.0, 0.0, 0.1),  # V
    "asymmetry": Unknown(-0.95, 0.95, 0.0, 0.2),
    "pendulum_viscous": Unknown(0.0, 100.0),  # V s/rad
    "pendulum_coulomb": Unknown(0.0, 100.0, 0.0, 0.02),  # V
    "delay": Unknown(0.0, 0.05, 0.0, 0.005),  # s
    "lag": Unknown(0.0, 0.05, 0.0, 0.01),  # s
    "tilt_x": Unknown(-0.3, 0.3, 0.0, 0.05),  # rad
    "tilt_y": Unknown(-0.3, 0.3, 0.0, 0.05),  # rad
    "zero": Unknown(-0.5, 0.5, 0.0, 0.1),  # rad
    "ceiling": _POSITIVE,  # V
    "alpha1": Unknown(0.0, 100.0, 0.0, 0.02),  # V
    "stribeck_velocity": Unknown(-20.0, 15.0, math.log(_BRISTLE.stribeck_velocity), 1.0),  # rad/s
    "sigma0": Unknown(-20.0, 15.0, math.log(_BRISTLE.sigma0), 1.0),  # V/rad
    "sigma1": Unknown(-20.0, 15.0, math.log(_BRISTLE.sigma1), 1.0),  # V s/rad
}
_WAVE = re.compile(r"wave(\d+)_(cos|sin)")
_ZERO = re.compile(r"zero\d+")

BODY = ("arm_inertia", "beta", "gamma", "delta")
FRICTION = ("viscous", "coulomb", "asymmetry", "pendulum_viscous", "pendulum_coulomb")
SETUP = ("delay", "lag", "tilt_x", "tilt_y")
LUGRE = ("alpha1", "stribeck_velocity", "sigma0", "sigma1")
# Largest standard deviation of the logarithm of a value that is assumed: a factor of 2. The priors
# are weaker, because the data narrow them.
LARGEST_ASSUMED = 0.7
LOGARITHMIC = (*BODY, "stribeck_velocity", "sigma0", "sigma1", "ceiling")


def unknown(name: str) -> Unknown:
    """The unknown of this name."""
    if (wave := _WAVE.fullmatch(name)) is not None:
        # An unbalanced arm (order 1) on a base that is nearly level has little torque.
        return Unknown(-10.0, 10.0, 0.0, 0.02 if wave[1] == "1" else 0.1)
    return UNKNOWNS["zero" if is_zero(name) else name]


def assumed_spread(name: str) -> float:
    """Standard deviation of an unknown that is assumed at the mean of its prior."""
    return min(UNKNOWNS[name].spread, LARGEST_ASSUMED)


def wave_names(order: int) -> tuple[str, str]:
    """The amplitudes of the torque's cosine and sine wave with ``order`` waves per turn."""
    return f"wave{order}_cos", f"wave{order}_sin"


def wave_order(name: str) -> int | None:
    """Waves per turn of a wave's unknown; None for any other unknown."""
    wave = _WAVE.fullmatch(name)
    return None if wave is None else int(wave[1])


def zero_name(index: int) -> str:
    """The zero of the pendulum's angle in recording number ``index``, counted from 0."""
    return f"zero{index + 1}"


def is_zero(name: str) -> bool:
    """Whether an unknown is the zero of the pendulum's angle."""
    return name == "zero" or _ZERO.fullmatch(name) is not None


def prior(names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation of the priors, in the optimiser's coordinates."""
    return (
        np.array([unknown(name).mean for name in names]),
        np.array([unknown(name).spread for name in names]),
    )


def prior_information(names: Sequence[str]) -> np.ndarray:
    """What the priors alone say: the inverse of their covariance (n, n)."""
    _, spread = prior(names)
    return np.diag(1.0 / spread**2)


@dataclass(frozen=True)
class ParameterValues:
    """One value per unknown, by name, in the coordinates of the optimiser."""

    coordinates: Mapping[str, float]

    @classmethod
    def of(cls, **given: float) -> ParameterValues:
        """From physical values; all others are at the mean of their prior, without a ceiling."""
        coordinates = {name: about.mean for name, about in UNKNOWNS.items()} | {"ceiling": math.inf}
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
            self["delay"],
            self["lag"],
            self["ceiling"],
        )


def bounds(start: ParameterValues, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest vector of some unknowns in a fit from ``start``."""
    unknowns = [unknown(name) for name in names]
    low, high = np.array([u.low for u in unknowns]), np.array([u.high for u in unknowns])
    reach = np.array([LARGEST_LOG_CHANGE if name in LOGARITHMIC else np.inf for name in names])
    vector = start.vector(names)
    return np.maximum(low, vector - reach), np.minimum(high, vector + reach)
