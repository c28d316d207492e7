"""What both pages show and measure; ``guided_scenes.yaml`` holds it."""

from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from furuta.quantities import QUANTITIES
from furuta.settings.nodes import FRICTION_OBSERVER, NODES, PLANT
from furuta.settings.parameter_names import by_node
from furuta.settings.recommended import (
    RECOMMENDED,
    RECOMMENDED_NAMES,
    RECOMMENDED_WORD,
    is_recommended,
    recommended_values,
)
from furuta.settings.settings import loop
from furuta_model.parameters import ParameterError
from furuta_ros.yaml_files import parse_yaml

FILE = "guided_scenes.yaml"
CONTENT = parse_yaml(files(__package__).joinpath(FILE).read_text(encoding="utf-8"), FILE)
# Plain name and symbol of each parameter in sight, and what each compensation is called.
IN_SIGHT: dict[str, dict[str, Any]] = CONTENT["in_sight"]
COMPENSATIONS: dict[str, str] = CONTENT["compensations"]
COMPENSATION = f"{FRICTION_OBSERVER}.compensation"
# Values by node and parameter name.
Values = Mapping[str, Mapping[str, Any]]


def scenes() -> list[dict[str, Any]]:
    """The scenes with their steps; what is always set is part of each one's settings."""
    return [
        scene
        | {
            "steps": [
                step | {"settings": CONTENT["always"] | step.get("settings", {})}
                for step in scene["steps"]
            ]
        }
        for scene in CONTENT["scenes"]
    ]


def scene_names() -> list[str]:
    """Full names of all parameters that the steps of scenes change."""
    steps = [step for scene in scenes() for step in scene["steps"]]
    own = {name for step in steps for name in (*step["settings"], *step.get("times", {}))}
    return sorted(own.union(RECOMMENDED_NAMES))


def page_content() -> dict[str, Any]:
    """What the page over a graph shows; it learns the rest from the nodes."""
    shown = {name: CONTENT[name] for name in ("measured", "what_if", "words")}
    look = {name: each._asdict() for name, each in QUANTITIES.items()}
    return shown | {"scenes": scenes(), "names": scene_names(), "quantities": look}


def expanded_values(entered: Mapping[str, Any], values: Values) -> dict[str, Any]:
    """Values by full name for what a user has entered, or a step sets.

    *recommended* stands for several.
    """
    if not is_recommended(COMPENSATION, entered.get(COMPENSATION)):
        return dict(entered)
    if PLANT not in values:
        raise ParameterError("recommended needs a simulated plant; a rig is told of its drive")
    own = by_node({each: value for each, value in entered.items() if each != COMPENSATION})
    rig = loop({n: {**values.get(n, {}), **own.get(n, {})} for n in NODES})
    return {**entered, **recommended_values(rig)}


def shown_compensation(values: Values) -> Any:
    """The node's word for the compensation; *recommended* for what nodes have in its place."""
    word = values.get(FRICTION_OBSERVER, {}).get("compensation")
    return RECOMMENDED if word == RECOMMENDED_WORD else word
