"""The recommended compensation, ``compensation=recommended``: settings of two nodes from a model.

It is the LuGre observer with super-twisting of limited bandwidth on top. Where the model of the
observer is right no fast correction is needed, and where it is wrong super-twisting corrects it.
The bounds follow from the highest friction level and the sample time.
"""

from collections.abc import Mapping
from typing import Any

from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.lugre import highest_level
from furuta_model.parameters import build

RECOMMENDED = "recommended"
# What it sets of the controller.
CONTROLLER_NAMES = ("super_twisting", "super_twisting_bandwidth", "vibration_limit")
# Rate at which friction may change and vibration that is accepted, relative to its highest level
# [1/s, 1]. On the paper's rig C is 10 V/s and the limit 0.4 V.
RATE, VIBRATION = 43.0, 1.7
# Bandwidth [1/s]: between those at which a belt of 50 Hz vibrates and friction moves the arm by a
# count of the encoder; at most this per sample.
BANDWIDTH, LARGEST_STEP = 80.0, 0.1


def is_recommended(name: str, value: Any) -> bool:
    """Whether a setting asks for the recommended compensation."""
    return value == RECOMMENDED and name in ("compensation", "friction_observer.compensation")


def recommended_values(settings: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Values by full name, from the friction model of the ``settings``."""
    p = build(ObserverParameters, settings["friction_observer"])
    level = float(highest_level(p.friction))
    numbers = RATE * level, min(BANDWIDTH, LARGEST_STEP / p.sample_time), VIBRATION * level
    controller = zip(CONTROLLER_NAMES, numbers, strict=True)
    return {
        "friction_observer.compensation": "lugre",
        **{f"controller.{name}": value for name, value in controller},
    }
