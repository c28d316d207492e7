"""Simulated rigs of a comparison: each sets parameters of the plant alone.

Estimator, friction observer and controller keep the values of the settings. So the rigs show what a
compensation does when the truth is not its model. The named rigs are the truths of the table in
docs/comparison.md.
"""

from typing import Any, NamedTuple

from furuta_model.parameters import build, values
from furuta_sim.parameters import PlantParameters
from furuta_sim.settings.nodes import NODES
from furuta_sim.settings.settings import Settings

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

    Each states every value that any of them changes.
    """
    nominal = nominal_values(settings)
    changes = _changes(nominal)
    names = dict.fromkeys(name for change in changes.values() for name in change)
    unchanged = {name: nominal[name] for name in names}
    return [SimulatedRig(name, unchanged | change) for name, change in changes.items()]


def _changes(nominal: PlantValues) -> dict[str, PlantValues]:
    """What each named rig changes. The last one tests that compensation does no harm."""

    def scaled(factor: float, *names: str) -> PlantValues:
        return {name: factor * nominal[name] for name in names}

    levels = "friction.alpha0", "friction.alpha1"
    return {
        "nominal": {},
        "levels x 0.7": scaled(0.7, *levels),
        "levels x 1.3": scaled(1.3, *levels),
        "sigma0 x 0.5": scaled(0.5, "friction.sigma0"),
        "sigma0 x 2": scaled(2.0, "friction.sigma0"),
        "sigma0 = 1000": {"friction.sigma0": 1000.0},
        "sigma0 = 10000": {"friction.sigma0": 10000.0},
        "Coulomb, sticking": {"friction.law": "coulomb", "friction.alpha1": 0.0},
        "stiction, sticking": {"friction.law": "stiction"},
        "alpha1 = 0.2": {"friction.alpha1": 0.2},
        "alpha1 = 0.2, sticking": {"friction.law": "stiction", "friction.alpha1": 0.2},
        "asymmetry 0.3": {"friction.asymmetry": 0.3},
        "levels ±30 %, 50 per turn": {
            "friction.variation.angle": 0.3,
            "friction.variation.angle_periods": 50,
        },
        "cogging 0.05 V": {"cogging.torque": 0.05},
        "no friction": {
            "friction.alpha0": 0.0,
            "friction.alpha1": 0.0,
            "friction.viscous": 0.0,
        },
    }
