"""What both pages show and measure; ``guided_scenes.yaml`` holds it."""

from collections.abc import Mapping
from importlib.resources import files
from typing import Any, NamedTuple

from furuta.settings.nodes import CONTROLLER, FRICTION_OBSERVER, NODES, PLANT
from furuta.settings.parameter_names import by_node
from furuta.settings.recommended import (
    RECOMMENDED,
    RECOMMENDED_NAMES,
    is_recommended,
    recommended_values,
)
from furuta.settings.settings import loop
from furuta_model.parameters import ParameterError
from furuta_ros.yaml_files import parse_yaml

FILE = "guided_scenes.yaml"
CONTENT = parse_yaml(files(__package__).joinpath(FILE).read_text(encoding="utf-8"), FILE)
# Plain name and symbol of each parameter in sight, and what each compensation is called.
IN_SIGHT = {name: " ".join(about.values()) for name, about in CONTENT["in_sight"].items()}
COMPENSATIONS: dict[str, str] = CONTENT["compensations"]
SUPER_TWISTING = "super_twisting"
# Values by node and parameter name.
Values = Mapping[str, Mapping[str, Any]]


class Measured(NamedTuple):
    """Times [s] after the start of a step at which it pushes and is measured, and how long."""

    push_after: float
    settled: float
    window: float


MEASURED = Measured(**CONTENT["measured"])


class Scene(NamedTuple):
    """Short name, title and text of a scene, and whether it shows predictions."""

    name: str
    title: str
    text: str
    predict: bool = False


class Step(NamedTuple):
    """A step of a scene: its name, what it changes, and where to look.

    It sets parameters (by full name), multiplies others by a number of ``times``, and pushes.
    """

    name: str
    look: str
    scene: Scene
    settings: Mapping[str, Any]
    times: Mapping[str, float] = {}
    push: Mapping[str, float] = {}


def guided_steps() -> list[Step]:
    """The steps of all scenes; what is always set is part of each one's settings."""
    found = []
    for number, content in enumerate(CONTENT["scenes"], 1):
        about = {name: value for name, value in content.items() if name != "steps"}
        scene = Scene(**about | {"name": f"{number} {content['name']}"})
        for step in content["steps"]:
            settings = CONTENT["always"] | step.get("settings", {})
            found.append(Step(**step | {"settings": settings, "scene": scene}))
    return found


def names_of(steps: list[Step]) -> list[str]:
    """Full names of all parameters that the steps change."""
    own = {name for step in steps for name in (*step.settings, *step.times)}
    return sorted(own.union(RECOMMENDED_NAMES))


def values_of(names: list[str], values: Values) -> dict[str, Any] | None:
    """Values by full name; None if a node does not run or has not such a parameter."""
    places = [name.partition(".")[::2] for name in names]
    if any(name not in values.get(node, {}) for node, name in places):
        return None
    return {f"{node}.{name}": values[node][name] for node, name in places}


def step_values(step: Step, before: Mapping[str, Any], values: Values) -> dict[str, Any]:
    """Values by full name of all parameters in ``before``, for this step."""
    scaled = {name: factor * before[name] for name, factor in step.times.items()}
    new = dict(before) | dict(step.settings) | scaled
    if any(is_recommended(*item) for item in step.settings.items()):
        rig = by_node(before)
        new |= recommended_values(loop({n: {**values.get(n, {}), **rig.get(n, {})} for n in NODES}))
    return new


def entered_values(node: str, name: str, value: Any, values: Values) -> dict[str, Any]:
    """Values by full name for what a user has entered among the parameters in sight.

    *recommended* stands for several, and another compensation after it ends its super-twisting.
    """
    entered = {f"{node}.{name}": value}
    if (node, name) == (FRICTION_OBSERVER, "compensation"):
        if is_recommended(name, value):
            if PLANT not in values:
                raise ParameterError("recommended needs a simulated plant; tune a rig instead")
            return recommended_values(loop({n: dict(values.get(n, {})) for n in NODES}))
        if shown_compensation(values) == RECOMMENDED:
            entered[f"{CONTROLLER}.{SUPER_TWISTING}"] = 0.0
    return entered


def shown_compensation(values: Values) -> Any:
    """The node's word for the compensation; *recommended* for what nodes have in its place."""
    word = values.get(FRICTION_OBSERVER, {}).get("compensation")
    twists = values.get(CONTROLLER, {}).get(SUPER_TWISTING)
    return RECOMMENDED if word == "lugre" and twists else word
