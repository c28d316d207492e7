"""The guided scenes and what each of their steps sets; ``guided_scenes.yaml`` holds them."""

from collections.abc import Mapping
from importlib.resources import files
from typing import Any, NamedTuple

from furuta.settings.nodes import NODES
from furuta.settings.parameter_names import by_node
from furuta.settings.recommended import RECOMMENDED_NAMES, is_recommended, recommended_values
from furuta.settings.settings import loop
from furuta_ros.yaml_files import parse_yaml

FILE = "guided_scenes.yaml"
# Values by node and parameter name.
Values = Mapping[str, Mapping[str, Any]]


class Step(NamedTuple):
    """A step: title and three sentences of its scene, name, where to look, and what it changes.

    It sets parameters (by full name), multiplies others by a number of ``times``, and pushes.
    """

    title: str
    text: str
    name: str
    look: str
    settings: Mapping[str, Any]
    times: Mapping[str, float] = {}
    push: Mapping[str, float] = {}


def guided_steps() -> list[Step]:
    """The steps of all scenes; what is always set is part of each one's settings."""
    content = parse_yaml(files(__package__).joinpath(FILE).read_text(), FILE)
    return [
        Step(
            title=f"{number} {scene['title']}",
            text=scene["text"],
            **step | {"settings": content["always"] | step.get("settings", {})},
        )
        for number, scene in enumerate(content["scenes"], 1)
        for step in scene["steps"]
    ]


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
    """Values by full name of all parameters that any step changes, for this step."""
    scaled = {name: factor * before[name] for name, factor in step.times.items()}
    new = dict(before) | dict(step.settings) | scaled
    if any(is_recommended(*item) for item in step.settings.items()):
        rig = by_node(before)
        new |= recommended_values(loop({n: {**values.get(n, {}), **rig.get(n, {})} for n in NODES}))
    return new
