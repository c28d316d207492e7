"""Simulated rigs of a comparison: each sets parameters of the plant alone.

Estimator, friction observer and controller keep the values of the settings. So the rigs show what a
compensation does when the truth is not its model. The named rigs are the truths of the table in
docs/results.md. Random rig k of a seed is the same in a comparison of any size: its parameters
are drawn from the covariance of a rig file if it states one, otherwise it differs from the settings
in friction law, friction and pendulum. Disturbances come on top. Each has a random stream of its
own, so a further one leaves the other choices as they are.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from math import pi
from typing import Any, NamedTuple

import numpy as np

from furuta.settings.nodes import NODES
from furuta.settings.settings import Settings, loop
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import CERTAIN, Uncertainty, changed_rig
from furuta_model.friction.laws import LAWS
from furuta_model.parameters import ParameterError, build, shortened, values
from furuta_model.parts.coupling import SIDES
from furuta_sim.parameters import PlantParameters

# Relative errors of the friction parameters and of each coefficient of the pendulum.
FRICTION_ERROR, MODEL_ERROR = 0.3, 0.1
_FRICTION = ("sigma0", "sigma1", "alpha0", "alpha1", "stribeck_velocity", "viscous")
_LEVELS = "friction.alpha0", "friction.alpha1"
_MODEL = ("alpha", "beta", "gamma", "delta")
DISTURBANCES = ("delay", "lag", "noise", "turn", "asymmetry", "cogging", "coupling")
# Largest values of the disturbances: delay and lag of the drive [s], factor on the tachometer's
# noise, amplitude of the level over the turn, difference between the directions, cogging [V],
# backlash [rad].
LARGEST_DELAY, LARGEST_LAG = 0.005, 0.010
LARGEST_NOISE_FACTOR = 10.0
LARGEST_CHANGE, LARGEST_ASYMMETRY, LARGEST_COGGING, LARGEST_BACKLASH = 0.3, 0.3, 0.05, 0.005
# Natural frequencies of an elastic coupling [Hz].
LOWEST_FREQUENCY, HIGHEST_FREQUENCY = 50.0, 150.0
# Elastic couplings of the named rigs: frequencies [Hz] by the side of the sensors, and backlash.
BELTS = {"arm": (20, 50, 60, 80, 150), "motor": (20, 60, 150)}
BACKLASH = {"arm": (5,), "motor": (1, 5, 17, 30)}  # [mrad]
GEAR_FREQUENCY = 150.0  # [Hz]
# Delay and lag [ms] of late drives of the named rigs, and factors on their Coulomb friction.
LATE = {(0, 20): (1,), (3, 10): (1,), (5, 10): (1, 0.3, 0.1, 0), (10, 15): (1, 0.3, 0.1, 0)}

MOST_RIGS = 1_000_000
# Streams of rigs to judge by and of rigs to train on.
JUDGING, TRAINING = 0, 1
NOMINAL = Rig()
# Points that are drawn together.
_DRAWN = 1024

# Values of parameters of the plant by full name.
PlantValues = dict[str, Any]


class SimulatedRig(NamedTuple):
    """Name of a rig, and the parameters of its plant that replace those of the settings."""

    name: str
    values: PlantValues

    def plant(self, settings: Settings) -> PlantParameters:
        """The plant. ParameterError if the parameters are impossible."""
        node: Any = build(NODES["plant"].parameters, settings["plant"] | self.values)
        plant: PlantParameters = node.plant
        return plant


def nominal_values(settings: Settings) -> PlantValues:
    """Values of all parameters of the plant that the settings describe."""
    return values(build(NODES["plant"].parameters, settings["plant"]))


def named_rigs(settings: Settings) -> list[SimulatedRig]:
    """The named rigs; factors apply to the plant of the settings.

    Each states every value that any of them changes. Those without friction test that compensation
    does no harm.
    """
    nominal = nominal_values(settings)
    scaled = partial(_scaled, nominal)
    changes: dict[str, PlantValues] = {
        "nominal": {},
        "levels x 0.7": scaled(0.7, *_LEVELS),
        "levels x 1.3": scaled(1.3, *_LEVELS),
        "sigma0 x 0.5": scaled(0.5, "friction.sigma0"),
        "sigma0 x 2": scaled(2.0, "friction.sigma0"),
        "sigma0 = 1000": {"friction.sigma0": 1000.0},
        "sigma0 = 10000": {"friction.sigma0": 10000.0},
        "Coulomb, sticking": _coulomb(nominal),
        "Coulomb x 0.1": _coulomb(nominal, 0.1),
        "Coulomb x 3": _coulomb(nominal, 3),
        "stiction, sticking": _friction(law="stiction"),
        "alpha1 = 0.2": {"friction.alpha1": 0.2},
        "alpha1 = 0.2, sticking": _friction(law="stiction", alpha1=0.2),
        "Stribeck, alpha1 = 0.29": _friction(law="stribeck", alpha1=0.29, stribeck_velocity=0.02),
        "asymmetry 0.3": {"friction.asymmetry": 0.3},
        "levels ±30 %, 50 per turn": {
            "friction.variation.angle": 0.3,
            "friction.variation.angle_periods": 50,
        },
        "cogging 0.05 V": {"cogging.torque": 0.05},
        "no friction": dict.fromkeys((*_LEVELS, "friction.viscous"), 0.0),
    }
    changes |= _couplings() | dict(_late(nominal)) | _sticking_couplings(nominal)
    changes |= {
        "tachometer off by 0.05 rad/s": {"sensor_faults.arm_speed_bias": 0.05},
        "pendulum's joint 2 mV": {"pendulum_friction.coulomb": 0.002} | _coulomb(nominal),
    }
    names = dict.fromkeys(name for change in changes.values() for name in change)
    unchanged = {name: nominal[name] for name in names}
    return [SimulatedRig(name, unchanged | change) for name, change in changes.items()]


def _scaled(nominal: PlantValues, factor: float, *names: str) -> PlantValues:
    return {name: factor * nominal[name] for name in names}


def _coulomb(nominal: PlantValues, factor: float = 1.0) -> PlantValues:
    """Friction that truly sticks, at a multiple of the nominal level."""
    levels = _scaled(nominal, factor, "friction.alpha0", "friction.viscous")
    return _friction(law="coulomb", alpha1=0.0) | levels


def _friction(**values: float | str) -> PlantValues:
    return {f"friction.{name}": value for name, value in values.items()}


def _late(nominal: PlantValues) -> Iterator[tuple[str, PlantValues]]:
    """Drives with delay and lag [ms], with Coulomb friction times a factor."""
    for (delay, lag), factors in LATE.items():
        samples = round(delay / 1000 / nominal["sample_time"])
        drive = {"drive.delay": samples, "drive.lag": lag / 1000}
        for factor in factors:
            yield f"delay {delay} lag {lag}, x {factor}", drive | _coulomb(nominal, factor)


def _sticking_couplings(nominal: PlantValues) -> dict[str, PlantValues]:
    """Elastic couplings with friction that truly sticks, or with little."""
    coulomb, without = _coulomb(nominal), _coulomb(nominal, 0)
    stiction, little = _friction(law="stiction"), _scaled(nominal, 0.03, *_LEVELS)
    belts = {f"belt {hz} Hz, Coulomb": _coupling(hz, "arm") | coulomb for hz in (20, 25, 50)}
    return belts | {
        "belt 30 Hz, stiction 0.2 V": _coupling(30, "arm") | _friction(law="stiction", alpha1=0.2),
        "belt 50 Hz, motor, x 0.03": _coupling(50, "motor") | little,
        "backlash 5 mrad, Coulomb": _coupling(100, "arm", backlash=0.005) | coulomb,
        "backlash 5 mrad, stiction": _coupling(80, "arm", backlash=0.005) | stiction,
        "backlash 5 mrad, no friction": _coupling(100, "arm", backlash=0.005) | without,
        "backlash 17, arm, Coulomb": _coupling(100, "arm", backlash=0.017) | coulomb,
        "backlash 17, motor, Coulomb": _coupling(100, "motor", backlash=0.017) | coulomb,
    }


def _couplings() -> dict[str, PlantValues]:
    """Elastic couplings of motor and arm."""
    changes = {
        f"belt {frequency} Hz, {side}": _coupling(frequency, side)
        for side, frequencies in BELTS.items()
        for frequency in frequencies
    }
    changes |= {
        f"backlash {gap} mrad, {side}": _coupling(GEAR_FREQUENCY, side, backlash=gap / 1000)
        for side, gaps in BACKLASH.items()
        for gap in gaps
    }
    gear = _coupling(GEAR_FREQUENCY, "motor", backlash=0.005, arm_friction=0.5)
    return changes | {"gear, friction on both sides": gear}


def _coupling(frequency: float, sensors: str, **others: float) -> PlantValues:
    values = {"frequency": float(frequency), "sensors": sensors, **others}
    return {f"coupling.{name}": value for name, value in values.items()}


@dataclass(frozen=True)
class RandomRigs:
    """The first ``size`` random rigs of a ``seed`` about the plant of the settings.

    ``disturbances`` are some of :data:`DISTURBANCES`, or all. ``uncertainty`` is that of a ``rig``
    file.
    """

    settings: Settings
    size: int
    seed: int = 0
    disturbances: tuple[str, ...] = ()
    rig: Rig = NOMINAL
    uncertainty: Uncertainty = CERTAIN
    purpose: int = JUDGING

    def __post_init__(self) -> None:
        """Reject what would mean no rigs, or others than the names say."""
        for name in self.disturbances:
            if name not in (*DISTURBANCES, "all"):
                known = ", ".join(DISTURBANCES)
                raise ParameterError(f"disturbances are {known} or all, given {shortened(name)}")
        if not (0 < self.size <= MOST_RIGS and self.seed >= 0):
            raise ParameterError(
                f"the number of rigs must be 1 to {MOST_RIGS} and the seed at least 0, given "
                f"{shortened(self.size)} and {shortened(self.seed)}"
            )

    def __len__(self) -> int:
        """The number of rigs."""
        return self.size

    def __iter__(self) -> Iterator[SimulatedRig]:
        """Generate the rigs in order."""
        nominal = nominal_values(self.settings)
        rig = _with_plant(self.rig, loop(self.settings).plant)
        for number, change in zip(range(self.size), self._changes(), strict=False):
            if len(change):
                chosen = _drawn(changed_rig(rig, self.uncertainty.names, change))
            else:
                chosen = self._truth(number, nominal)
            for stream, name in enumerate(DISTURBANCES, start=1):
                if {name, "all"} & {*self.disturbances}:
                    chosen |= _disturbance(name, self._stream(number, stream), nominal)
            yield SimulatedRig(str(number), chosen)

    def _changes(self) -> Iterator[np.ndarray]:
        """Changes of the uncertain coordinates, without end; empty ones if none is uncertain."""
        generator = np.random.default_rng(
            self.seed if self.purpose == JUDGING else (self.seed, self.purpose)
        )
        while True:
            yield from self.uncertainty.draws(_DRAWN, generator)

    def _truth(self, number: int, nominal: PlantValues) -> PlantValues:
        """Friction law, unless the settings have an own one, friction parameters and pendulum."""
        r = self._stream(number, 0)
        law, own = LAWS[int(r.integers(len(LAWS)))], nominal["friction.law"]
        chosen: PlantValues = {"friction.law": law if own in LAWS else own}
        errors = {f"friction.{name}": FRICTION_ERROR for name in _FRICTION}
        errors |= {f"model.{name}": MODEL_ERROR for name in _MODEL}
        for name, error in errors.items():
            chosen[name] = nominal[name] * r.uniform(1.0 - error, 1.0 + error)
        return chosen

    def _stream(self, number: int, stream: int) -> np.random.Generator:
        key = self.purpose, number, stream
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=key))


def _disturbance(name: str, r: np.random.Generator, nominal: PlantValues) -> PlantValues:
    """Random parameters of one of :data:`DISTURBANCES`."""
    if name == "delay":
        return {"drive.delay": round(r.uniform(0.0, LARGEST_DELAY) / nominal["sample_time"])}
    if name == "lag":
        return {"drive.lag": r.uniform(0.0, LARGEST_LAG)}
    if name == "noise":
        noise = "sensors.tachometer_noise"
        return {noise: r.uniform(1.0, LARGEST_NOISE_FACTOR) * nominal[noise]}
    if name == "coupling":
        ratio = HIGHEST_FREQUENCY / LOWEST_FREQUENCY
        return _coupling(
            LOWEST_FREQUENCY * ratio ** r.uniform(0.0, 1.0),
            SIDES[int(r.integers(2))],
            motor_inertia=r.uniform(0.2, 0.8),
            backlash=r.uniform(0.0, LARGEST_BACKLASH),
            arm_friction=r.uniform(0.0, 1.0),
        )
    return _friction_disturbance(name, r)


def _friction_disturbance(name: str, r: np.random.Generator) -> PlantValues:
    """Random parameters of a disturbance that depends on the arm's angle or direction."""
    if name == "turn":
        return {
            "friction.variation.angle": r.uniform(0.0, LARGEST_CHANGE),
            "friction.variation.angle_periods": int(r.integers(1, 5)),
            "friction.variation.angle_phase": r.uniform(-pi, pi),
        }
    if name == "asymmetry":
        return {"friction.asymmetry": r.uniform(-LARGEST_ASYMMETRY, LARGEST_ASYMMETRY)}
    return {
        "cogging.torque": r.uniform(0.0, LARGEST_COGGING),
        "cogging.periods": int(r.integers(10, 201)),
        "cogging.phase": r.uniform(-pi, pi),
    }


def _with_plant(rig: Rig, plant: PlantParameters) -> Rig:
    """The rig with the values of the plant, about which others are drawn."""
    return rig._replace(
        model=plant.model,
        friction=plant.friction.parameters,
        pendulum_friction=plant.pendulum_friction,
        tilt=plant.tilt,
        waves=plant.waves,
    )


def _drawn(rig: Rig) -> PlantValues:
    """What can be uncertain in a rig file, as parameters of the plant."""
    return {
        **values(rig.model, "model."),
        **values(rig.friction, "friction."),
        **values(rig.pendulum_friction, "pendulum_friction."),
        **values(rig.tilt, "tilt."),
        **values(rig.waves, "waves."),
        "drive.delay": rig.drive_dynamics.late.delay,
    }
