"""The verbs on transfer functions as a user meets them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import click
import pytest
from sources import ROOT

from furuta_bringup import main

PNG = b"\x89PNG"


def test_nyquist_figure_4(furuta: Any, tmp_path: Path) -> None:
    """Case a crosses, b does not, c and d start on the negative real axis; and a picture."""
    picture = tmp_path / "new" / "figure4.png"
    status, out, err = furuta("nyquist", "--figure-4", "--out", picture, "--json")
    assert status == 0, err
    result = json.loads(out)
    assert [(each["case"], each["omega_rad_s"]) for each in result["crossings"]] == [
        ("a", pytest.approx(3.057, abs=1e-3)),
        ("c", 0.0),
        ("d", 0.0),
    ]
    assert "steady rotation: at 0.21 rad/s" in result["cases"]["c"]["note"]
    assert picture.read_bytes().startswith(PNG)


def test_verbs_of_the_readme_have_the_options_that_it_names() -> None:
    """README: all accept these, and all but ``convergence`` a friction law."""
    readme = (ROOT / "README.md").read_text()
    table = readme[readme.index("| question | verb |") :].split("\n\n")[0]
    verbs = set(re.findall(r"`([a-z-]+)[ `]", table))
    assert {"simulate", "convergence", "limit-cycle", "map", "nyquist"} < verbs
    assert "All but `convergence` accept a friction law (`--law`)." in readme
    for verb in verbs:
        options = {name for each in _verb(verb).params for name in each.opts}
        assert {"--json", "--set", "--params", "--out", "--feedback"} <= options, verb
        assert ("--law" in options) == (verb != "convergence"), verb


def _verb(name: str) -> click.Command:
    found = main.furuta.get_command(click.Context(main.furuta), name)
    assert found is not None
    return found


def test_nyquist_of_the_controller(furuta: Any) -> None:
    """The default feedback is the controller's own gain."""
    result = json.loads(furuta("nyquist", "--json")[1])
    placed = json.loads(furuta("linearize", "--json")[1])
    assert result["feedback"] == pytest.approx([-each for each in placed["L"]])
    assert result["stable_without_friction"] is True
    (crossing,) = result["crossings"]
    assert crossing["omega_rad_s"] == pytest.approx(3.0301, abs=1e-4)


@pytest.mark.parametrize(
    ("law", "width", "period"), [("coulomb", 0.6425, 2.0736), ("lugre", 0.6369, 2.1491)]
)
def test_describing_function(
    furuta: Any, tmp_path: Path, law: str, width: float, period: float
) -> None:
    """The predicted limit cycle of the rig, with pictures."""
    out_file, curves = tmp_path / "n.png", tmp_path / "laws.png"
    presliding = tmp_path / "presliding.png"
    status, out, err = furuta(
        "describing-function",
        "--law",
        law,
        "--json",
        "--out",
        out_file,
        "--curves",
        curves,
        "--presliding",
        presliding,
    )
    assert status == 0, err
    (cycle,) = json.loads(out)["cycles"]
    assert cycle["phi_peak_to_peak_rad"] == pytest.approx(width, abs=1e-4)
    assert cycle["period_s"] == pytest.approx(period, abs=1e-4)
    assert cycle["stable"] is True
    assert out_file.read_bytes().startswith(PNG)
    assert curves.read_bytes().startswith(PNG)
    assert presliding.read_bytes().startswith(PNG)


def test_parameters_and_feedback_reach_it(furuta: Any) -> None:
    """Friction twice as strong, cycle twice as wide; without φ no cycle but rotations."""
    result = json.loads(
        furuta("describing-function", "--law", "coulomb", "--set", "alpha0=0.42", "--json")[1]
    )
    assert result["cycles"][0]["phi_peak_to_peak_rad"] == pytest.approx(2 * 0.6425, abs=2e-4)
    result = json.loads(
        furuta("describing-function", "--feedback", "0", "7", "60", "20", "--json")[1]
    )
    assert result["cycles"] == []
    assert [each["rate_rad_s"] for each in result["rotations"]] == pytest.approx(
        [0.03208, -0.03208], abs=1e-5
    )
    assert "steady rotation" in result["note"]


def test_convergence(furuta: Any, tmp_path: Path) -> None:
    """The paper's K does not satisfy the condition, and the reason is given."""
    picture = tmp_path / "new" / "g.png"
    status, out, err = furuta("convergence", "--json", "--out", picture)
    assert status == 0, err
    result = json.loads(out)
    assert picture.read_bytes().startswith(PNG)
    assert result["satisfied"] is False
    assert "5.09 1/s in the right half plane" in result["reason"]
    assert result["K"] == 0.01
    assert result["L"] == pytest.approx(json.loads(furuta("linearize", "--json")[1])["L"])
    assert [5.0903, 0.0] in [[round(each, 4) for each in zero] for zero in result["zeros"]]
    assert result["static_gain"] == pytest.approx(80 / result["L"][0])
    assert result["smallest_real_part"] == pytest.approx(result["static_gain"])
    assert result["at_omega_rad_s"] == 0.0
    assert result["violated_rad_s"][1][1] is None
    assert result["largest_stable_gain"] == {
        "positive": 0.0,
        "negative": pytest.approx(0.03228, abs=1e-5),
    }
    assert result["friction_passive"] is False
    assert result["passive_error"]["smallest_real_part"] > 0.0
    assert result["exact_model"] is True


def test_convergence_takes_feedback_and_parameters(furuta: Any) -> None:
    """The verb uses gain, friction and feedback, and reports a model mismatch."""
    status, out, err = furuta(
        "convergence",
        "--json",
        "--feedback",
        *("10", "4", "60", "20"),
        *("--set", "observer_gain=-0.5", "--set", "plant.friction.viscous=0.2"),
    )
    assert status == 0, err
    result = json.loads(out)
    assert (result["K"], result["L"]) == (-0.5, [-10, -4, -60, -20])
    assert result["static_gain"] == pytest.approx(-8.0)
    assert result["friction_passive"] is True
    assert result["exact_model"] is False
    assert "differs from the plant's" in result["reason"]


@pytest.mark.parametrize("verb", ["nyquist", "describing-function"])
def test_for_people(furuta: Any, verb: str) -> None:
    """Without --json the same in words."""
    status, out, _ = furuta(verb, "--feedback", "10", "4", "60", "20")
    assert status == 0
    assert "60 θ +20 θ̇" in out


@pytest.mark.parametrize(
    "arguments",
    [
        ("--feedback", "0", "0", "0", "0"),
        ("--feedback", "0", "-1", "60", "20"),
        ("--set", "alpha0=0", "--set", "alpha1=0", "--law", "coulomb"),
    ],
)
def test_degenerate_loops_are_drawn(furuta: Any, tmp_path: Path, arguments: tuple[str]) -> None:
    """Loops without feedback, or without friction, give a picture and no warning."""
    for verb in ("nyquist", "describing-function", "convergence"):
        if verb == "convergence":
            arguments = tuple(each for each in arguments if each not in ("--law", "coulomb"))
        picture = tmp_path / f"{verb}.png"
        status, _, err = furuta(verb, *arguments, "--out", picture)
        assert (status, err) == (0, "")
        assert picture.read_bytes().startswith(PNG)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["nyquist", "--feedback", "nan", "1", "1", "1"], "four finite numbers"),
        (["describing-function", "--feedback", "1", "inf", "1", "1"], "four finite numbers"),
        (["nyquist", "--figure-4", "--feedback", "1", "1", "1", "1"], "cannot be combined"),
        (["describing-function", "--set", "sigma0=-1"], "sigma0 must be"),
        (["convergence", "--feedback", "1", "1", "1", "nan"], "four finite numbers"),
        (["convergence", "--set", "observer_gain=1e9"], "observer_gain must be"),
        (["nyquist", "--set", "gamma=1"], "alpha * beta must exceed gamma²"),
    ],
)
def test_bad_input_is_one_line(furuta: Any, arguments: list[str], reason: str) -> None:
    """Exit status 1, the reason on standard error, nothing on standard output."""
    status, out, err = furuta(*arguments)
    assert status == 1
    assert out == ""
    assert reason in err
    assert len(err.strip().splitlines()) == 1
