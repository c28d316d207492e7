"""Declared parameters: values are converted to a validated group and back."""

import math
from typing import Any

import numpy as np
import pytest

from furuta.settings.nodes import NODES
from furuta_control.control import ControllerParameters
from furuta_model.parameters import (
    ParameterError,
    build,
    declared,
    values,
)
from furuta_sim.parameters import PlantParameters

# Ends of names of parameters that a condition couples.
COUPLED = ("_angle", "sample_time", "alpha0", "alpha1", "viscous")


def test_an_empty_list_is_the_default() -> None:
    """ROS cannot know the type of an empty list, so no parameter has one as its value."""
    assert build(ControllerParameters, {"gain": []}) == ControllerParameters()
    every = (each for about in NODES.values() for each in declared(about.parameters))
    lists = [each for each in every if each.kind is list]
    assert {each.default for each in lists} == {(0.0,)}


def test_messages_shorten_what_was_given() -> None:
    """A value of very many characters, from a message or a file, does not fill the log."""
    long = "x" * 100_000
    for given in ({"mode": long}, {"gain": [long] * 3}, {"gain": [1.0] * 10**4}):
        with pytest.raises(ParameterError) as caught:
            build(ControllerParameters, given)
        assert len(str(caught.value)) < 300


@pytest.mark.parametrize("node", NODES)
def test_round_trip(node: str) -> None:
    """Allowed values survive ``build`` and ``values`` unchanged."""
    rng = np.random.default_rng(6)
    for _ in range(20):
        given: dict[str, Any] = {}
        for each in declared(NODES[node].parameters):
            low, high = max(each.about.low, -1e3), min(each.about.high, 1e3)
            if each.name.startswith("model.") or each.name.endswith(COUPLED):
                continue
            if each.kind is float:
                given[each.name] = rng.uniform(low, high)
            elif each.kind is int:
                given[each.name] = int(rng.integers(low, high, endpoint=True))
            elif each.kind is bool:
                given[each.name] = bool(rng.integers(2))
            elif each.about.choices:
                given[each.name] = str(rng.choice(each.about.choices))
            elif each.kind is list:
                given[each.name] = list(rng.uniform(low, high, 4))
        kept = values(build(NODES[node].parameters, given))
        assert {name: kept[name] for name in given} == given


@pytest.mark.parametrize("node", NODES)
def test_numbers_are_checked(node: str) -> None:
    """Both limits are allowed; the message names parameter, range, unit and the given value."""
    group = NODES[node].parameters
    for each in declared(group):
        if each.kind not in (float, int):
            continue
        for wrong in (math.nan, math.inf, True, "1", None, [1.0]):
            with pytest.raises(
                ParameterError, match=rf"^{each.name} must be (finite|a number|an integer)"
            ):
                build(group, {each.name: wrong})
        about = each.about
        for limit, outward in ((about.low, -1), (about.high, 1)):
            if math.isinf(limit):
                continue
            assert each.checked(each.kind(limit)) == limit
            outside = each.kind(limit + outward * max(1, abs(limit) / 2))
            with pytest.raises(ParameterError) as refusal:
                build(group, {each.name: outside})
            message = str(refusal.value)
            assert message.startswith(f"{each.name} must be ")
            assert message.endswith(f"given {outside:g}")
            assert f"{limit:g}" in message
            assert about.unit in message


def test_whole_numbers() -> None:
    """A float accepts an integer and is a float; an integer rejects a float."""
    stiffness = build(PlantParameters, {"friction.sigma0": 80}).friction.parameters.sigma0
    assert (stiffness, type(stiffness)) == (80.0, float)
    with pytest.raises(ParameterError, match=r"seed must be an integer, given 7\.0"):
        build(PlantParameters, {"seed": 7.0})


@pytest.mark.parametrize("node", NODES)
def test_choices(node: str) -> None:
    """Each choice is accepted; any other word is rejected with the list of choices."""
    group = NODES[node].parameters
    for each in declared(group):
        for choice in each.about.choices:
            assert values(build(group, {each.name: choice}))[each.name] == choice
        own = ", or one of own_parts" if each.about.own else ""
        listed = f"{each.name} must be one of {', '.join(each.about.choices)}{own}, given 'other'"
        if each.about.choices:
            with pytest.raises(ParameterError, match=listed):
                build(group, {each.name: "other"})
