"""Random simulated rigs: rig k of a seed is the same in a comparison of any size.

Their parameters are drawn from the covariance of a rig file if it states one, or lie in given
ranges, or differ from the settings in everything: friction law, friction and pendulum. Disturbances
come on top. Each has a random stream of its own, so a further one leaves the other choices as they
are.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

from furuta.studies.comparison.candidates import Range, checked_range
from furuta.studies.comparison.named_rigs import PlantValues, SimulatedRig, nominal_values
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import CERTAIN, Uncertainty, changed_rig
from furuta_model.friction.laws import LAWS
from furuta_model.parameters import ParameterError, values
from furuta_sim.parameters import PlantParameters
from furuta_sim.settings.parameter_names import parameters_named
from furuta_sim.settings.settings import Settings, loop

# Relative errors of the friction parameters and of each coefficient of the pendulum.
FRICTION_ERROR, MODEL_ERROR = 0.3, 0.1
_FRICTION = ("sigma0", "sigma1", "alpha0", "alpha1", "stribeck_velocity", "viscous")
_MODEL = ("alpha", "beta", "gamma", "delta")
# Largest values of the disturbances: delay and lag of the drive [s], factor on the tachometer's
# noise, amplitude of the level over the turn, difference between the directions, cogging [V].
LARGEST_DELAY, LARGEST_LAG = 0.005, 0.010
LARGEST_NOISE_FACTOR = 10.0
LARGEST_CHANGE, LARGEST_ASYMMETRY, LARGEST_COGGING = 0.3, 0.3, 0.05

# Streams of rigs to judge by and of rigs to tune on.
JUDGING, TUNING = 0, 1
NOMINAL = Rig()
# Points that are drawn together.
_DRAWN = 1024

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


DISTURBANCES: dict[str, Disturb] = {
    "delay": _delay,
    "lag": _lag,
    "noise": _noise,
    "turn": _turn,
    "asymmetry": _asymmetry,
    "cogging": _cogging,
}


@dataclass(frozen=True)
class RandomRigs:
    """The first ``size`` random rigs of a ``seed`` about the plant of the settings.

    ``ranges`` are those of parameters of the plant by full name, and replace what the
    ``uncertainty`` of a ``rig`` file says about them.
    """

    settings: Settings
    size: int
    seed: int = 0
    disturbances: tuple[str, ...] = ()
    ranges: tuple[tuple[str, Range], ...] = ()
    rig: Rig = NOMINAL
    uncertainty: Uncertainty = CERTAIN
    purpose: int = JUDGING

    def __len__(self) -> int:
        """The number of rigs."""
        return self.size

    def __iter__(self) -> Iterator[SimulatedRig]:
        """Generate the rigs in order."""
        nominal, drawn = nominal_values(self.settings), len(self.uncertainty.names)
        rig = _with_plant(self.rig, loop(self.settings).plant)
        for number, point in zip(range(self.size), self._points(), strict=False):
            chosen = self._truth(number, nominal)
            if drawn:
                chosen = _drawn(changed_rig(rig, self.uncertainty.names, point[:drawn]))
            chosen |= self._within(point[drawn:]) | self._disturbed(number, nominal)
            yield SimulatedRig(str(number), chosen)

    def _points(self) -> Iterator[np.ndarray]:
        """Points without end: changes of the uncertain coordinates, then fractions of ranges."""
        generator = np.random.default_rng(
            self.seed if self.purpose == JUDGING else (self.seed, self.purpose)
        )
        while True:
            changes = self.uncertainty.draws(_DRAWN, generator)
            yield from np.hstack((changes, generator.random((_DRAWN, len(self.ranges)))))

    def _truth(self, number: int, nominal: PlantValues) -> PlantValues:
        """Friction law, friction parameters and pendulum, unless something else is uncertain."""
        if self.ranges or self.uncertainty.names:
            return {}
        r = self._stream(number, 0)
        chosen: PlantValues = {"friction.law": LAWS[int(r.integers(len(LAWS)))]}
        errors = {f"friction.{name}": FRICTION_ERROR for name in _FRICTION}
        errors |= {f"model.{name}": MODEL_ERROR for name in _MODEL}
        for name, error in errors.items():
            chosen[name] = nominal[name] * r.uniform(1.0 - error, 1.0 + error)
        return chosen

    def _within(self, fractions: np.ndarray) -> PlantValues:
        pairs = zip(self.ranges, fractions, strict=True)
        return {name: low + float(x) * (high - low) for (name, (low, high)), x in pairs}

    def _disturbed(self, number: int, nominal: PlantValues) -> PlantValues:
        chosen: PlantValues = {}
        for stream, (name, disturb) in enumerate(DISTURBANCES.items(), start=1):
            if name in self.disturbances:
                chosen |= disturb(self._stream(number, stream), nominal)
        return chosen

    def _stream(self, number: int, stream: int) -> np.random.Generator:
        key = self.purpose, number, stream
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=key))


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
        "drive.delay": rig.drive_dynamics.delay,
    }


def parse_ranges(texts: Iterable[str]) -> tuple[tuple[str, Range], ...]:
    """The parameters of the plant that NAME=LOW:HIGH names, and their ranges."""
    ranges: dict[str, Range] = {}
    for text in texts:
        name, _, limits = text.partition("=")
        matches = parameters_named(name.strip())
        parameters = [match.parameter for match in matches if match.node == "plant"]
        if not parameters:
            raise ParameterError(f"rigs can differ in parameters of the plant, given {name}")
        ranges |= {parameter.name: checked_range(parameter, limits) for parameter in parameters}
    return tuple(ranges.items())
