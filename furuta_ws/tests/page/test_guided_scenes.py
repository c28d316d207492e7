"""The guided scenes without a page: what they set, and what is in sight."""

from furuta.settings.nodes import NODES
from furuta.settings.parameter_names import by_node
from furuta.settings.settings import default_settings, parameters_of
from furuta_bringup.page.guided_scenes import (
    IN_SIGHT,
    scene_names,
    scenes,
)
from furuta_model.parameters import build, values

STEPS = [step for scene in scenes() for step in scene["steps"]]
VALUES = {node: values(group) for node, group in parameters_of(default_settings()).items()}


def test_steps_set_what_nodes_accept() -> None:
    """Every step changes only names that all steps set, so none is left over from another one."""
    names = scene_names()
    before = {name: VALUES[name.partition(".")[0]][name.partition(".")[2]] for name in names}
    for step in STEPS:
        scaled = {name: factor * before[name] for name, factor in step.get("times", {}).items()}
        new = before | step["settings"] | scaled
        assert sorted(new) == names
        for node, changed in by_node(new).items():
            build(NODES[node].parameters, VALUES[node] | changed)


def test_names_in_sight_are_those_of_the_graph() -> None:
    for name in IN_SIGHT:
        node, _, own = name.partition(".")
        assert own in VALUES[node]
