"""What the page is told of a rig and of a parameter, and what it may set."""

import pytest
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from furuta_bringup.page.described import Described
from furuta_bringup.page.guided_scenes import IN_SIGHT
from furuta_bringup.page.nodes_on_page import plain
from furuta_bringup.page.rig_status import rig_status
from furuta_model.parameters import ParameterError

IDLE = "yet; active, stops: 0"


def test_silent_bridge_is_not_shown_as_it_was() -> None:
    """A bridge that has ended said last that it is armed; that may be wrong now."""
    said = {"armed": "True", "state": "active", "stops": "0"}
    values = [KeyValue(key=key, value=value) for key, value in said.items()]
    status = DiagnosticStatus(message="driving", values=values)
    assert "no diagnostics" in rig_status(None, 1.0)["text"]
    assert rig_status(status, 1.0)["title"] == "ARMED"
    assert rig_status(status, 30.0)["title"] == "unknown"
    values[0].value, status.message = "False", "not armed yet"
    assert rig_status(status, 1.0) == {"title": "not armed", "kind": "", "text": IDLE}
    assert "silent for 30 s" in rig_status(status, 30.0)["text"]


@pytest.mark.parametrize(
    ("value", "given", "accepted"),
    [
        (0.2, 3, 3.0),
        (0.2, "1e-3", 1e-3),
        (5, "7", 7),
        ([0.0], "[1, 2]", [1.0, 2.0]),
        ([0.0], [1, 2.5], [1.0, 2.5]),
        ("lugre", "coulomb", "coulomb"),
        (True, False, False),
    ],
)
def test_values_have_the_type_of_the_parameter(
    value: object, given: object, accepted: object
) -> None:
    found = Described("name", value).accepted(given)
    assert found == accepted
    assert type(found) is type(accepted)


@pytest.mark.parametrize(
    ("value", "wrong"),
    [
        ([0.0], ("a b", [[1.0]], "[1, x]")),
        (0.2, ("high", True, [1.0], None)),
        (5, (2**70,)),
        ("lugre", (3, {})),
        (True, (1,)),
    ],
)
def test_other_values_are_refused(value: object, wrong: tuple[object, ...]) -> None:
    for given in wrong:
        with pytest.raises(ParameterError, match="must be"):
            Described("name", value).accepted(given)


@pytest.mark.parametrize("name", IN_SIGHT)
def test_a_parameter_in_sight_may_have_any_value(name: str) -> None:
    """A node of another kind may have one of that name; it has a control all the same."""
    node, _, own = name.partition(".")
    for value in (float("inf"), float("nan"), 1e300, 0.0, "text", [1.0], True, None, b"x"):
        for low, high in ((float("-inf"), float("inf")), (0.0, 0.0), (5.0, -5.0)):
            assert Described(own, value, low=low, high=high, node=node).about()["name"] == name


def test_every_value_of_a_parameter_can_be_told() -> None:
    """JSON in a browser has no infinite number and no bytes."""
    told = plain([1.5, float("inf"), float("nan"), b"\x01", "a", True, None])
    assert told == [1.5, "inf", "nan", "01", "a", True, None]
