"""The guided scenes without a page: what they set, and what is in sight."""

import numpy as np
import pytest

from furuta.settings.nodes import CONTROLLER, FRICTION_OBSERVER, NODES
from furuta.settings.parameter_names import by_node
from furuta.settings.settings import default_settings, parameters_of
from furuta_bringup.page.guided_scenes import (
    COMPENSATIONS,
    IN_SIGHT,
    entered_values,
    guided_steps,
    names_of,
    shown_compensation,
    step_values,
    values_of,
)
from furuta_bringup.page.simulation_controls import has_fallen
from furuta_friction.compensation import COMPENSATIONS as OF_NODE
from furuta_model.parameters import ParameterError, build, values

STEPS = guided_steps()
VALUES = {node: values(group) for node, group in parameters_of(default_settings()).items()}


def test_steps_set_what_nodes_accept() -> None:
    """Every step sets every parameter that any changes, so none is left over from another one."""
    names = names_of(STEPS)
    before = values_of(names, VALUES)
    assert before is not None
    for step in STEPS:
        new = step_values(step, before, VALUES)
        assert sorted(new) == names
        for node, changed in by_node(new).items():
            build(NODES[node].parameters, VALUES[node] | changed)


def test_no_scenes_where_a_node_is_missing() -> None:
    """On a rig there is no plant."""
    rig = {node: group for node, group in VALUES.items() if node != "plant"}
    assert values_of(names_of(STEPS), rig) is None


def test_names_in_sight_are_those_of_the_graph() -> None:
    assert values_of(list(IN_SIGHT), VALUES) is not None
    assert {*COMPENSATIONS} <= {*OF_NODE, "recommended"}


def test_recommended_is_a_compensation_of_three_nodes() -> None:
    """It is shown in place of what nodes have for it; another one ends its super-twisting."""
    entered = entered_values(FRICTION_OBSERVER, "compensation", "recommended", VALUES)
    assert entered["friction_observer.compensation"] == "lugre"
    nodes = {node: VALUES[node] | by_node(entered).get(node, {}) for node in VALUES}
    assert nodes[CONTROLLER]["super_twisting"] > 0.0
    assert shown_compensation(nodes) == "recommended"
    entered = entered_values(FRICTION_OBSERVER, "compensation", "lugre", nodes)
    nodes = {node: nodes[node] | by_node(entered).get(node, {}) for node in nodes}
    assert shown_compensation(nodes) == "lugre"
    with pytest.raises(ParameterError, match="needs a simulated plant"):
        entered_values(FRICTION_OBSERVER, "compensation", "recommended", {CONTROLLER: {}})


def test_fall_is_where_the_controller_gives_up() -> None:
    assert has_fallen(-0.71, VALUES)
    assert not has_fallen(2.0 * np.pi + 0.1, VALUES)
