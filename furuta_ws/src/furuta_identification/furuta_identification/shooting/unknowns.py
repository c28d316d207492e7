"""The unknown parameters of the model: units, ranges, priors.

Inertias are fitted as logarithms of β, γ, δ and of α − γ²/β, so that every vector is a possible
pendulum. Parameters that the data may not determine have a prior, a mean and a standard deviation.
It is as weak as an engineer's expectation: friction no larger than needed, a base nearly level.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from furuta_model.friction.parameters import Friction


class Unknown(NamedTuple):
    """An unknown parameter: unit, allowed range, mean and standard deviation of its prior."""

    name: str
    unit: str
    low: float
    high: float
    mean: float
    spread: float


_NO_PRIOR = (0.0, math.inf)
_BRISTLE = Friction()


def _positive(name: str, unit: str, mean: float = 0.0, spread: float = math.inf) -> Unknown:
    """An unknown that is fitted as its logarithm."""
    return Unknown(name, unit, -20.0, 15.0, mean, spread)


UNKNOWNS = (
    _positive("arm_inertia", "V s²/rad"),
    _positive("beta", "V s²/rad"),
    _positive("gamma", "V s²/rad"),
    _positive("delta", "V/rad"),
    Unknown("viscous", "V s/rad", -10.0, 100.0, *_NO_PRIOR),
    Unknown("coulomb", "V", 0.0, 100.0, 0.0, 0.1),
    Unknown("asymmetry", "", -0.95, 0.95, 0.0, 0.2),
    Unknown("pendulum_viscous", "V s/rad", -10.0, 100.0, *_NO_PRIOR),
    Unknown("pendulum_coulomb", "V", -10.0, 100.0, 0.0, 0.02),
    Unknown("delay", "s", -0.05, 0.05, 0.0, 0.005),
    Unknown("lag", "s", 0.0, 0.05, 0.0, 0.01),
    Unknown("tilt_x", "rad", -0.3, 0.3, 0.0, 0.05),
    Unknown("tilt_y", "rad", -0.3, 0.3, 0.0, 0.05),
    Unknown("unbalance_cos", "V", -10.0, 10.0, 0.0, 0.02),
    Unknown("unbalance_sin", "V", -10.0, 10.0, 0.0, 0.02),
    Unknown("zero", "rad", -0.5, 0.5, 0.0, 0.1),
    Unknown("ripple_order", "1/turn", 0.0, 1000.0, *_NO_PRIOR),
    Unknown("ripple_cos", "V", -10.0, 10.0, 0.0, 0.1),
    Unknown("ripple_sin", "V", -10.0, 10.0, 0.0, 0.1),
    Unknown("alpha1", "V", 0.0, 100.0, 0.0, 0.02),
    _positive("stribeck_velocity", "rad/s", math.log(_BRISTLE.stribeck_velocity), 1.0),
    _positive("sigma0", "V/rad", math.log(_BRISTLE.sigma0), 1.0),
    _positive("sigma1", "V s/rad", math.log(_BRISTLE.sigma1), 1.0),
)
BY_NAME = {each.name: each for each in UNKNOWNS}
INDEX = {each.name: index for index, each in enumerate(UNKNOWNS)}

BODY = ("arm_inertia", "beta", "gamma", "delta")
FRICTION = ("viscous", "coulomb", "asymmetry", "pendulum_viscous", "pendulum_coulomb")
TIMING = ("delay", "lag")
SETUP = ("tilt_x", "tilt_y", "unbalance_cos", "unbalance_sin", "zero")
RIPPLE = ("ripple_cos", "ripple_sin")
LUGRE = ("alpha1", "stribeck_velocity", "sigma0", "sigma1")
LOGARITHMIC = (*BODY, "stribeck_velocity", "sigma0", "sigma1")


def prior(names: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation of the priors, in the optimiser's coordinates."""
    return (
        np.array([BY_NAME[name].mean for name in names]),
        np.array([BY_NAME[name].spread for name in names]),
    )
