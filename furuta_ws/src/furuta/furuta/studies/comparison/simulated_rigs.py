"""Simulated rigs of a comparison: each sets parameters of the plant alone.

Estimator, friction observer and controller keep the nominal values of the settings. So the rigs
show what a compensation does when the truth is not its model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from furuta_model.parameters import build, values
from furuta_sim.parameters import PlantParameters
from furuta_sim.settings.nodes import NODES
from furuta_sim.settings.settings import Settings

# Values of parameters of the plant by full name.
PlantValues = dict[str, Any]


class SimulatedRig(NamedTuple):
    """Name of a rig, and the parameters of its plant that differ from the settings."""

    name: str
    values: PlantValues

    def plant(
        self, settings: Settings, seed: int, push: float, push_time: float
    ) -> PlantParameters:
        """The plant with noise ``seed``; ``push`` [V] acts on the arm from ``push_time`` [s].

        Raises ParameterError if the parameters are impossible.
        """
        given = settings["plant"] | self.values | {"seed": seed}
        if push:
            given |= {"pushes.times": (push_time,), "pushes.durations": (PUSH_DURATION,)}
            given |= {"pushes.arm": (push,), "pushes.pendulum": (0.0,)}
        node: Any = build(NODES["plant"].parameters, given)
        plant: PlantParameters = node.plant
        return plant


# Duration of a push on the arm [s].
PUSH_DURATION = 0.1


def _levels(factor: float) -> Callable[[PlantValues], PlantValues]:
    return lambda nominal: _scaled(nominal, factor, "friction.alpha0", "friction.alpha1")


def _stiffness(factor: float) -> Callable[[PlantValues], PlantValues]:
    return lambda nominal: _scaled(nominal, factor, "friction.sigma0")


def _scaled(nominal: PlantValues, factor: float, *names: str) -> PlantValues:
    return {name: factor * nominal[name] for name in names}


def _fixed(given: PlantValues) -> Callable[[PlantValues], PlantValues]:
    return lambda nominal: given


# Values by name from those of the nominal plant. The last row tests that compensation does no harm.
NAMED: dict[str, Callable[[PlantValues], PlantValues]] = {
    "nominal": _fixed({}),
    "levels x 0.7": _levels(0.7),
    "levels x 1.3": _levels(1.3),
    "sigma0 x 0.5": _stiffness(0.5),
    "sigma0 x 2": _stiffness(2.0),
    "sigma0 = 1000": _fixed({"friction.sigma0": 1000.0}),
    "sigma0 = 10000": _fixed({"friction.sigma0": 10000.0}),
    "Coulomb, sticking": _fixed({"friction.law": "coulomb", "friction.alpha1": 0.0}),
    "stiction, sticking": _fixed({"friction.law": "stiction"}),
    "alpha1 = 0.2": _fixed({"friction.alpha1": 0.2}),
    "alpha1 = 0.2, sticking": _fixed({"friction.law": "stiction", "friction.alpha1": 0.2}),
    "asymmetry 0.3": _fixed({"friction.asymmetry": 0.3}),
    "levels ±30 %, 50 per turn": _fixed(
        {"friction.variation.angle": 0.3, "friction.variation.angle_periods": 50}
    ),
    "cogging 0.05 V": _fixed({"cogging.torque": 0.05}),
    "no friction": _fixed(
        {"friction.alpha0": 0.0, "friction.alpha1": 0.0, "friction.viscous": 0.0}
    ),
}


def named_rigs(settings: Settings) -> Iterator[SimulatedRig]:
    """The named rigs; factors apply to the plant of the settings."""
    nominal = nominal_values(settings)
    for name, make in NAMED.items():
        yield SimulatedRig(name, make(nominal))


def nominal_values(settings: Settings) -> PlantValues:
    """Values of all parameters of the plant that the settings describe."""
    return values(build(NODES["plant"].parameters, settings["plant"]))
