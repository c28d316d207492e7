"""Random simulated rigs: rig k of a seed is the same alone and in any batch.

Every choice has a random stream of its own, so a further disturbance leaves the other choices as
they are.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np

from furuta.studies.comparison.simulated_rigs import PlantValues, SimulatedRig
from furuta_model.friction.laws import LAWS

# Relative errors of the friction parameters and of each coefficient of the pendulum.
FRICTION_ERROR, MODEL_ERROR = 0.3, 0.1
# Largest values of the disturbances: delay and lag of the drive [s], factor on the tachometer's
# noise, amplitude of the level over the turn, difference between the directions, cogging [V].
LARGEST_DELAY, LARGEST_LAG = 0.005, 0.010
LARGEST_NOISE_FACTOR = 10.0
LARGEST_CHANGE, LARGEST_ASYMMETRY, LARGEST_COGGING = 0.3, 0.3, 0.05

# Streams of rigs to judge by and of rigs to tune on.
JUDGING, TUNING = 0, 1

Disturb = Callable[[np.random.Generator, PlantValues], PlantValues]


def _delay(r: np.random.Generator, nominal: PlantValues) -> PlantValues:
    return {"drive.delay": round(r.uniform(0.0, LARGEST_DELAY) / nominal["sample_time"])}


def _lag(r: np.random.Generator, nominal: PlantValues) -> PlantValues:
    return {"drive.lag": r.uniform(0.0, LARGEST_LAG)}


def _noise(r: np.random.Generator, nominal: PlantValues) -> PlantValues:
    name = "sensors.tachometer_noise"
    return {name: r.uniform(1.0, LARGEST_NOISE_FACTOR) * nominal[name]}


def _turn(r: np.random.Generator, nominal: PlantValues) -> PlantValues:
    return {
        "friction.variation.angle": r.uniform(0.0, LARGEST_CHANGE),
        "friction.variation.angle_periods": int(r.integers(1, 5)),
        "friction.variation.angle_phase": r.uniform(-pi, pi),
    }


def _asymmetry(r: np.random.Generator, nominal: PlantValues) -> PlantValues:
    return {"friction.asymmetry": r.uniform(-LARGEST_ASYMMETRY, LARGEST_ASYMMETRY)}


def _cogging(r: np.random.Generator, nominal: PlantValues) -> PlantValues:
    return {
        "cogging.torque": r.uniform(0.0, LARGEST_COGGING),
        "cogging.periods": int(r.integers(10, 201)),
        "cogging.phase": r.uniform(-pi, pi),
    }


# What can be added to the random friction and pendulum, by name.
DISTURBANCES: dict[str, Disturb] = {
    "delay": _delay,
    "lag": _lag,
    "noise": _noise,
    "turn": _turn,
    "asymmetry": _asymmetry,
    "cogging": _cogging,
}


def random_rig(
    nominal: PlantValues,
    number: int,
    seed: int,
    disturbances: tuple[str, ...] = (),
    purpose: int = JUDGING,
) -> SimulatedRig:
    """Rig ``number`` of a ``seed``, from the ``nominal`` values of the plant.

    The friction law is one of all; each friction parameter is within ±30 %, each coefficient of the
    pendulum within ±10 %.
    """
    chosen = _truth(_stream(seed, purpose, number, 0), nominal)
    for stream, (name, disturb) in enumerate(DISTURBANCES.items(), start=1):
        if name in disturbances:
            chosen |= disturb(_stream(seed, purpose, number, stream), nominal)
    return SimulatedRig(str(number), chosen)


def _truth(r: np.random.Generator, nominal: PlantValues) -> PlantValues:
    """Friction law, friction parameters and pendulum."""
    chosen: PlantValues = {"friction.law": LAWS[int(r.integers(len(LAWS)))]}
    errors = {f"friction.{name}": FRICTION_ERROR for name in _FRICTION}
    errors |= {f"model.{name}": MODEL_ERROR for name in _MODEL}
    for name, error in errors.items():
        chosen[name] = nominal[name] * r.uniform(1.0 - error, 1.0 + error)
    return chosen


_FRICTION = ("sigma0", "sigma1", "alpha0", "alpha1", "stribeck_velocity", "viscous")
_MODEL = ("alpha", "beta", "gamma", "delta")


def _stream(seed: int, purpose: int, number: int, stream: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(purpose, number, stream)))
