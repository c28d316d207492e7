"""Earlier names and values of parameters."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import pytest

from furuta_model.parameters import About, EarlierName, ParameterError
from furuta_ros.renamed_parameters import renamed, with_current_names
from furuta_sim.settings.nodes import NODES, NodeDescription
from furuta_sim.settings.parameter_names import warn_once
from furuta_sim.settings.settings import load_settings, read_file, with_current_parameter_names


class Inner(NamedTuple):
    """A group with a renamed parameter."""

    noise: Annotated[
        float, About("noise", "V", 0.0, 5.0, earlier_names=(EarlierName("spread"),))
    ] = 1.0


class Outer(NamedTuple):
    """A group with a parameter that replaced a switch in another group."""

    mode: Annotated[
        str,
        About(
            "mode",
            choices=("balance", "open_loop"),
            earlier_names=(
                EarlierName("inner.open_loop", ((True, "open_loop"), (False, "balance"))),
            ),
        ),
    ] = "balance"
    inner: Inner = Inner()


@pytest.fixture(autouse=True)
def every_warning() -> None:
    """Warnings that an earlier test has caused appear again."""
    warn_once.cache_clear()


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> str:
    """A node of the graph with these parameters."""
    monkeypatch.setitem(NODES, "mine", NodeDescription("mine", "p", "e", Outer, "m:C"))
    return "mine"


def test_full_earlier_names() -> None:
    """Earlier names are relative to the group that declares the parameter."""
    assert set(renamed(Outer)) == {"inner.spread", "inner.open_loop"}
    assert renamed(Outer)["inner.spread"].parameter.name == "inner.noise"


@pytest.mark.parametrize(
    ("given", "expected", "warning"),
    [
        ({"inner.spread": 2.0}, {"inner.noise": 2.0}, "inner.spread is now called inner.noise"),
        ({"inner.spread": 2}, {"inner.noise": 2.0}, "inner.spread is now called inner.noise"),
        ({"inner.open_loop": True}, {"mode": "open_loop"}, "use mode=open_loop instead of"),
        ({"inner.open_loop": False}, {"mode": "balance"}, "use mode=balance instead of"),
    ],
)
def test_translation(given: dict[str, Any], expected: dict[str, Any], warning: str) -> None:
    """Names and values are the current ones, and the warning says what to write instead."""
    values, warnings = with_current_names(Outer, given)
    assert values == expected
    assert type(next(iter(values.values()))) is type(next(iter(expected.values())))
    assert len(warnings) == 1
    assert warning in warnings[0]


def test_the_current_name_takes_precedence() -> None:
    """In either order of the two."""
    for given in (
        {"inner.spread": 2.0, "inner.noise": 3.0},
        {"inner.noise": 3.0, "inner.spread": 2.0},
    ):
        assert with_current_names(Outer, given)[0] == {"inner.noise": 3.0}


def test_current_names_need_no_warning() -> None:
    """Values by current names are returned unchanged."""
    assert with_current_names(Outer, {"mode": "balance"}) == ({"mode": "balance"}, [])


@pytest.mark.parametrize(
    "assignment",
    ["inner.spread=2", "mine.inner.spread=2", "spread=2", "mine.inner.spread=2e0"],
)
def test_assignments(node: str, assignment: str, caplog: Any) -> None:
    """The command line accepts earlier names, with one warning."""
    assert load_settings([], [assignment, assignment])[node] == {"inner.noise": 2.0}
    assert [each.levelno for each in caplog.records] == [logging.WARNING]
    assert "mine: parameter inner.spread is now called inner.noise" in caplog.text


def test_assigned_values(node: str, caplog: Any) -> None:
    """Earlier values are translated; any other value is validated as a current one."""
    assert load_settings([], ["mine.inner.open_loop=true"])[node] == {"mode": "open_loop"}
    assert "use mode=open_loop instead of inner.open_loop=True" in caplog.text
    with pytest.raises(ParameterError, match=r"mode must be one of balance, open_loop, given 'x'"):
        load_settings([], ["mine.inner.open_loop=x"])
    with pytest.raises(ParameterError, match=r"inner.noise must be 0 to 5 V, given 6"):
        load_settings([], ["mine.inner.spread=6"])


def test_parameter_file_of_an_earlier_version(tmp_path: Path, caplog: Any) -> None:
    """A file with earlier names of the estimator loads, also one stored with an old bag."""
    file = tmp_path / "parameters.yaml"
    file.write_text(
        "/estimator:\n  ros__parameters: {friction_spread: 0.5, pendulum_spread: 1e-1}\n"
    )
    expected = {"friction_process_noise": 0.5, "pendulum_process_noise": 0.1}
    assert read_file(file)["estimator"] == expected
    assert (
        "estimator: parameter friction_spread is now called friction_process_noise" in caplog.text
    )
    assert "pendulum_process_noise" in caplog.text


def test_recorded_changes_of_an_earlier_version(caplog: Any) -> None:
    """Changes in a bag are translated too."""
    assert with_current_parameter_names(
        "estimator", {"friction_spread": 0.5, "method": "kalman"}
    ) == {
        "friction_process_noise": 0.5,
        "method": "kalman",
    }
    assert "friction_process_noise" in caplog.text
