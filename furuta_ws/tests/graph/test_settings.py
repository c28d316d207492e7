"""Settings from parameter files and NAME=VALUE assignments."""

from pathlib import Path
from typing import Any

import pytest

from furuta.settings.settings import default_settings, load_settings, read_file
from furuta_model.parameters import ParameterError


@pytest.fixture
def file(tmp_path: Path) -> Any:
    """Writes a parameter file."""

    def write(text: str, name: str = "rig.yaml") -> Path:
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def test_nested_and_dotted_names(file: Any) -> None:
    """A file may nest the groups or write full names."""
    nested = file("plant:\n  ros__parameters:\n    friction: {alpha0: 0.3}\n")
    dotted = file("/plant:\n  ros__parameters:\n    friction.alpha0: 0.3\n", "b.yaml")
    assert read_file(nested) == read_file(dotted)
    assert read_file(nested)["plant"] == {"friction.alpha0": 0.3}


def test_wildcard(file: Any) -> None:
    """/** sets the parameter in every node that has it and in no other."""
    settings = read_file(file("/**:\n  ros__parameters:\n    sample_time: 0.002\n"))
    assert settings == {
        "plant": {"sample_time": 0.002},
        "estimator": {"sample_time": 0.002},
        "friction_observer": {"sample_time": 0.002},
        "controller": {"sample_time": 0.002},
        "hardware_bridge": {},
    }


TWO = """
/**: {ros__parameters: {sample_time: 0.002}}
/left/plant: {ros__parameters: {friction: {alpha0: 0.1}}}
right: {plant: {ros__parameters: {friction: {alpha0: 0.4}}}}
"""


def test_each_graph_takes_the_sections_of_its_namespace(file: Any) -> None:
    """Also nested ones; without a namespace those of the only one."""
    two = file(TWO)
    for namespace, level in (("/left", 0.1), ("/right", 0.4)):
        expected = {"sample_time": 0.002, "friction.alpha0": level}
        assert load_settings([two], [], namespace=namespace)["plant"] == expected
    with pytest.raises(ParameterError, match="for several namespaces, /left, /right: start"):
        load_settings([two], [])
    one = file("/left/plant: {ros__parameters: {seed: 7}}")
    assert load_settings([one], [])["plant"] == {"seed": 7}
    with pytest.raises(ParameterError, match="no section for the namespace /right, only for /left"):
        load_settings([one], [], namespace="/right")


def test_later_wins(file: Any) -> None:
    """Files in their order, assignments after them."""
    first = file("estimator:\n  ros__parameters: {filter_bandwidth: 5e1, filter_damping: 1}\n")
    second = file("estimator:\n  ros__parameters: {filter_bandwidth: 60}\n", "b.yaml")
    assert load_settings([first, second], [])["estimator"] == {
        "filter_bandwidth": 60.0,
        "filter_damping": 1.0,
    }
    settings = load_settings([first, second], ["filter_bandwidth=70", "filter_bandwidth=80"])
    assert settings["estimator"]["filter_bandwidth"] == 80.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("plant:\n\tx: 1\n", "is not YAML: .* in line 2"),
        ("motor:\n  ros__parameters: {x: 1}\n", "no node motor; nodes are plant, estimator"),
        (
            "plant:\n  ros__parameters: {friction: {alfa0: 1}}\n",
            r"plant has no parameter friction\.alfa0; did you mean alpha0",
        ),
        ("/**:\n  ros__parameters: {friktion: 1}\n", r"/\*\* has no parameter friktion; did you"),
        (
            "plant:\n  ros__parameters: {friction: {alpha0: -1}}\n",
            r"friction\.alpha0 must be 0 to 100000 V, given -1",
        ),
    ],
)
def test_files_that_are_wrong(file: Any, text: str, message: str) -> None:
    """A wrong file is refused with what is wrong and where."""
    with pytest.raises(ParameterError, match=message):
        load_settings([file(text)], [])


def test_unknown_names_are_named(file: Any) -> None:
    """All of a few; of very many only the first ones, because each is compared with all known."""
    few, many = ("{seeed: 1, clocks: 2}", "{" + ", ".join(f"a{n}: 1" for n in range(5_000)) + "}")
    with pytest.raises(
        ParameterError, match=r"no parameter seeed; .*; plant has no parameter clocks"
    ):
        read_file(file(f"plant: {{ros__parameters: {few}}}"))
    with pytest.raises(ParameterError) as caught:
        read_file(file(f"plant: {{ros__parameters: {many}}}"))
    assert str(caught.value).count("no parameter") == 10


def test_a_node_of_the_users_own_has_its_own_parameters(file: Any) -> None:
    """In the section of the node that it replaces; those of ours still hold for the graph."""
    given = [file("friction_observer: {ros__parameters: {width: 0.1, alpha0: 0.3}}")]
    settings = load_settings(given, [], without=["friction_observer"])
    assert settings["friction_observer"] == {"alpha0": 0.3}
    with pytest.raises(ParameterError, match="friction_observer has no parameter width"):
        load_settings(given, [], without=["controller"])


@pytest.mark.parametrize(
    ("assignment", "expected"),
    [
        ("alpha0=0.3", {"plant": {"friction.alpha0": 0.3}, "friction_observer": {"alpha0": 0.3}}),
        (
            "alpha=0.03",
            {
                node: {"model.alpha": 0.03}
                for node in ("plant", "estimator", "friction_observer", "controller")
            },
        ),
        ("mode=off", {"controller": {"mode": "off"}}),
        ("observer_gain=1e-3", {"friction_observer": {"observer_gain": 0.001}}),
        ("gain=[1, 2, 3, 4]", {"controller": {"gain": (1.0, 2.0, 3.0, 4.0)}}),
        (" theta = 0.1", {"plant": {"initial.theta": 0.1}}),
    ],
)
def test_assignments(assignment: str, expected: dict[str, Any]) -> None:
    """A name means that parameter wherever it occurs; with the node before it, one."""
    assert load_settings([], [assignment]) == default_settings() | expected


def test_simulated_time_in_a_file_is_reported(file: Any, caplog: pytest.LogCaptureFixture) -> None:
    """It is ignored, but not silently; false is what the nodes have anyway."""
    for value, warnings in (("false", 0), ("true", 1)):
        path = file(f"/**: {{ros__parameters: {{use_sim_time: {value}}}}}", f"{value}.yaml")
        assert read_file(path) == default_settings()
        assert len(caplog.messages) == warnings
    assert "use_sim_time is ignored" in caplog.text
