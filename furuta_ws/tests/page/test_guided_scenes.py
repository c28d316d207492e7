"""The guided scenes without a page: what their steps set."""

import numpy as np

from furuta.settings.nodes import NODES
from furuta.settings.parameter_names import by_node
from furuta.settings.settings import default_settings, parameters_of
from furuta_bringup.page.guided_scenes import (
    guided_steps,
    names_of,
    step_values,
    values_of,
)
from furuta_bringup.page.simulation_controls import has_fallen
from furuta_model.parameters import build, values

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


def test_fall_is_where_the_controller_gives_up() -> None:
    assert has_fallen(-0.71, VALUES)
    assert not has_fallen(2.0 * np.pi + 0.1, VALUES)
