"""The guided scenes without a page: what their steps set; colours for colour-blind eyes."""

from itertools import combinations

import numpy as np
import pytest

from furuta_graph.settings.nodes import NODES
from furuta_graph.settings.settings import default_settings, parameters_of
from furuta_model.parameters import build, values
from furuta_view import charts
from furuta_view.fall_notice import has_fallen
from furuta_view.guided_scenes import (
    Step,
    by_node,
    guided_steps,
    names_of,
    step_values,
    values_of,
)
from furuta_view.parameter_types import slider_range

STEPS = guided_steps()
VALUES = {node: values(group) for node, group in parameters_of(default_settings()).items()}
# Linear sRGB as seen without one kind of cone: Machado, Oliveira, Fernandes 2009, severity 1.
SIGHT = {
    "normal": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
}
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
ONE_CHART = [
    [colour for _, colour, *_ in charts.ANGLES],
    [colour for _, colour, *_ in charts.VOLTAGES],
    [charts.GREY, charts.ARM],
]


def lab(colour: str, sight: str) -> np.ndarray:
    """CIE L*a*b* of a colour ``#rrggbb`` as it is seen."""
    values = np.array([int(colour[at : at + 2], 16) for at in (1, 3, 5)]) / 255
    linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    seen = XYZ @ np.clip(SIGHT[sight] @ linear, 0.0, 1.0) / XYZ.sum(axis=1)
    x, y, z = np.where(seen > 0.008856, np.cbrt(seen), 7.787 * seen + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("sight", SIGHT)
def test_colours_of_a_chart_differ(sight: str) -> None:
    """By ten times what an eye just notices (2.3), and more."""
    for colours in ONE_CHART:
        for one, other in combinations(colours, 2):
            assert np.linalg.norm(lab(one, sight) - lab(other, sight)) > 30.0


def test_each_scene_has_three_sentences_and_each_step_one_thing_to_look_at() -> None:
    for text in {step.text for step in STEPS}:
        assert text.count(". ") + text.endswith(".") == 3
    assert all(step.look.startswith("Look at ") for step in STEPS)


@pytest.mark.parametrize("step", STEPS, ids=lambda step: step.name)
def test_steps_set_what_nodes_accept(step: Step) -> None:
    """Every step sets every parameter that any changes, so none is left over from another one."""
    names = names_of(STEPS)
    before = values_of(names, VALUES)
    assert before is not None
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
    assert not has_fallen(0.69, VALUES)
    assert not has_fallen(2.0 * np.pi + 0.1, VALUES)
    assert not has_fallen(3.0, {})


def test_slider_reaches_the_recommended_super_twisting() -> None:
    """10 V/s, from 0, where the value tells no size."""
    assert slider_range(0.0, 0.0, 1e4) == (0.0, 20.0, 0.01)
