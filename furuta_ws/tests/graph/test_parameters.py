"""Declared parameters: values are converted to a validated group and back."""

import math
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

from furuta.settings.nodes import NODES
from furuta_control.control import ControllerParameters
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import (
    INLINE,
    About,
    Declared,
    ParameterError,
    build,
    declared,
    values,
)
from furuta_sim.parameters import PlantParameters

ALL = [(node, each) for node, about in NODES.items() for each in declared(about.parameters)]
NUMBERS = [(node, each) for node, each in ALL if each.kind in (float, int)]


def names(parameters: list[tuple[str, Declared]]) -> list[str]:
    return [f"{node}.{each.name}" for node, each in parameters]


class Inner(NamedTuple):
    """A nested group."""

    gain: Annotated[float, About("gain", "V/rad", 0.0, 5.0)] = 1.0
    taps: Annotated[tuple[float, ...], About("taps", "", -1.0)] = ()


class Outer(NamedTuple):
    """Groups nested with and without a name."""

    named: Inner = Inner()
    inline: Annotated[Friction, INLINE] = Friction()
    on: Annotated[bool, About("switch")] = False


def test_an_empty_list_is_the_default() -> None:
    """ROS cannot know the type of an empty list, so no parameter has one as its value."""
    assert build(ControllerParameters, {"gain": []}) == ControllerParameters()
    lists = [each for _, each in ALL if each.kind is list]
    assert {each.default for each in lists} == {(0.0,)}


def test_messages_shorten_what_was_given() -> None:
    """A value of millions of characters, from a message or a file, does not fill the log."""
    long = "x" * 5_000_000
    for given in ({"mode": long}, {"gain": [long] * 3}, {"gain": [1.0] * 10**6}):
        with pytest.raises(ParameterError) as caught:
            build(ControllerParameters, given)
        assert len(str(caught.value)) < 300


def test_names_of_nested_groups() -> None:
    """A nested group adds its field's name, an inline one does not."""
    expected = ["named.gain", "named.taps", *Friction._fields, "on"]
    assert [each.name for each in declared(Outer)] == expected
    assert list(values(Outer())) == expected
    assert build(Outer, {"named.gain": 2.0, "alpha0": 0.4}).inline.alpha0 == 0.4


@pytest.mark.parametrize("node", NODES)
def test_defaults_are_allowed(node: str) -> None:
    """A group built without values has its defaults, and all defaults are allowed."""
    group: Any = NODES[node].parameters
    assert build(group, {}) == group()
    assert build(group, values(group())) == group()


@pytest.mark.parametrize("node", NODES)
def test_round_trip(node: str) -> None:
    """Allowed values survive ``build`` and ``values`` unchanged."""
    rng = np.random.default_rng(6)
    for _ in range(20):
        given: dict[str, Any] = {}
        for each in declared(NODES[node].parameters):
            low, high = max(each.about.low, -1e3), min(each.about.high, 1e3)
            if each.name.startswith("model.") or each.name.endswith(("_angle", "sample_time")):
                continue  # coupled by a condition
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


@pytest.mark.parametrize(("node", "each"), NUMBERS, ids=names(NUMBERS))
def test_range_is_checked(node: str, each: Declared) -> None:
    """Both limits are allowed; the message names parameter, range, unit and the given value."""
    about = each.about
    for limit, outward in ((about.low, -1), (about.high, 1)):
        if math.isinf(limit):
            continue
        assert each.checked(each.kind(limit)) == limit
        outside = each.kind(limit + outward * max(1, abs(limit) / 2))
        with pytest.raises(ParameterError) as refusal:
            build(NODES[node].parameters, {each.name: outside})
        message = str(refusal.value)
        assert message.startswith(f"{each.name} must be ")
        assert message.endswith(f"given {outside:g}")
        assert f"{limit:g}" in message
        assert about.unit in message


@pytest.mark.parametrize(("node", "each"), NUMBERS, ids=names(NUMBERS))
@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, True, "1", None, [1.0]], ids=str)
def test_not_a_number(node: str, each: Declared, wrong: Any) -> None:
    """NaN, infinities, booleans, text and None are rejected as numbers, and the message says so."""
    with pytest.raises(ParameterError, match=rf"^{each.name} must be (finite|a number|an integer)"):
        build(NODES[node].parameters, {each.name: wrong})


def test_whole_numbers() -> None:
    """A float accepts an integer and is a float; an integer rejects a float."""
    built = build(PlantParameters, {"friction.sigma0": 80, "seed": 7})
    assert (built.friction.parameters.sigma0, type(built.friction.parameters.sigma0)) == (
        80.0,
        float,
    )
    assert (built.seed, type(built.seed)) == (7, int)
    with pytest.raises(ParameterError, match=r"seed must be an integer, given 7\.0"):
        build(PlantParameters, {"seed": 7.0})


@pytest.mark.parametrize(("node", "each"), [(n, e) for n, e in ALL if e.about.choices])
def test_choices(node: str, each: Declared) -> None:
    """Each choice is accepted; any other word is rejected with the list of choices."""
    for choice in each.about.choices:
        assert values(build(NODES[node].parameters, {each.name: choice}))[each.name] == choice
    own = ", or one of own_parts" if each.about.own else ""
    listed = f"{each.name} must be one of {', '.join(each.about.choices)}{own}, given 'other'"
    with pytest.raises(ParameterError, match=listed):
        build(NODES[node].parameters, {each.name: "other"})


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"gain": [1.0, 2.0, 3.0]}, r"gain must be four numbers .* given \[1.0, 2.0, 3.0\]"),
        ({"gain": [1.0, 2.0, 3.0, math.nan]}, "gain must be finite, given nan"),
        ({"gain": [1.0, 2.0, 3.0, "4"]}, "gain must be a number, given '4'"),
        ({"gain": "1234"}, "gain must be a list of numbers, given '1234'"),
        ({"gain": ""}, "gain must be a list of numbers, given ''"),
        ({"gain": [1.0]}, r"or \[0.0\] for pole placement, given \[1.0\]"),
        ({"model.gamma": 0.0204}, r"alpha \* beta must exceed .* gamma = 0\.0204"),
        ({"catch_angle": 0.8}, r"catch_angle must not exceed fall_angle, given 0\.8 > 0\.7"),
        ({"mode": "swing_up", "voltage_limit": 0.0}, "mode swing_up needs a feedback that catches"),
        ({"fall_angle": 0.1}, r"catch_angle must not exceed fall_angle, given 0\.2 > 0\.1"),
    ],
)
def test_contradictory_values_are_rejected(given: dict[str, Any], message: str) -> None:
    """Values that are wrong only in combination are rejected too."""
    with pytest.raises(ParameterError, match=message):
        build(ControllerParameters, given)
