"""The guided scenes without a page: what they set, and what is in sight."""

import pytest

from furuta.settings.nodes import CONTROLLER, NODES
from furuta.settings.parameter_names import by_node
from furuta.settings.settings import default_settings, parameters_of
from furuta_bringup.page.guided_scenes import (
    COMPENSATIONS,
    IN_SIGHT,
    expanded_values,
    scene_names,
    scenes,
    shown_compensation,
)
from furuta_friction.compensation import COMPENSATIONS as OF_NODE
from furuta_model.parameters import ParameterError, build, values

COMPENSATION = "friction_observer.compensation"
STEPS = [step for scene in scenes() for step in scene["steps"]]
VALUES = {node: values(group) for node, group in parameters_of(default_settings()).items()}


def test_steps_set_what_nodes_accept() -> None:
    """Every step changes only names that all steps set, so none is left over from another one."""
    names = scene_names()
    before = {name: VALUES[name.partition(".")[0]][name.partition(".")[2]] for name in names}
    for step in STEPS:
        scaled = {name: factor * before[name] for name, factor in step.get("times", {}).items()}
        new = expanded_values(before | step["settings"] | scaled, VALUES)
        assert sorted(new) == names
        for node, changed in by_node(new).items():
            build(NODES[node].parameters, VALUES[node] | changed)


def test_names_in_sight_are_those_of_the_graph() -> None:
    for name in IN_SIGHT:
        node, _, own = name.partition(".")
        assert own in VALUES[node]
    assert {*COMPENSATIONS} <= {*OF_NODE, "recommended"}


def test_recommended_is_a_compensation_of_three_nodes() -> None:
    """It is shown in place of what nodes have for it; another one ends its super-twisting."""
    entered = expanded_values({COMPENSATION: "recommended"}, VALUES)
    assert entered["friction_observer.compensation"] == "lugre"
    nodes = {node: VALUES[node] | by_node(entered).get(node, {}) for node in VALUES}
    assert nodes[CONTROLLER]["super_twisting"] > 0.0
    assert shown_compensation(nodes) == "recommended"
    entered = expanded_values({COMPENSATION: "lugre"}, nodes)
    nodes = {node: nodes[node] | by_node(entered).get(node, {}) for node in nodes}
    assert shown_compensation(nodes) == "lugre"
    with pytest.raises(ParameterError, match="needs a simulated plant"):
        expanded_values({COMPENSATION: "recommended"}, {CONTROLLER: {}})
