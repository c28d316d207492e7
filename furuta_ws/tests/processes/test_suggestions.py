"""Slips of new users: each message says what was meant, or what to do."""

from pathlib import Path
from typing import Any

import pytest

from furuta_model.parameters import suggestion


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ("identify run.csv --rig paper", "add --write FILE.yaml, or leave --rig out"),
        ("sweep alpha0", "such as alpha0=0.1:0.3:5, given 'alpha0'"),
        ("limit-cycle --over omega1", "such as omega1=2:12, given 'omega1'"),
        ("simulate --compensation Lugre", "given 'Lugre'; did you mean lugre?"),
        ("simulate --law LuGre", "'lugre', 'dahl', 'maxwell_slip'; did you mean lugre?"),
        ("simulate --rig my.yml", "cannot read parameter file"),
        ("simulate --rig rigs/mine", "cannot read parameter file"),
        ("simulate --rig Paper", "did you mean paper?"),
        ("simulate --second 3", "No such option '--second'. Did you mean '--seconds'? (see"),
        ("view --lockstep", "No such option '--lockstep'; options of furuta run come after --"),
        ("simulate -seconds 3", "No such option '-s'; write --NAME (see"),
        ("simulate --seconds 10s", "'10s' is not a number; give it without a unit"),
        ("map omega1=1:15", "Did you mean 'limit-cycle'?"),
        ("nyquist", "Did you mean 'linearize'?"),
        ("demo --out output/sweep.csv", "'output/sweep.csv' is a file"),
        ("param set controller omega1", "such as omega1=7"),
    ],
)
def test_a_slip(furuta: Any, tmp_path: Path, monkeypatch: Any, arguments: str, reason: str) -> None:
    """One line, also where the default of ``--out`` exists already."""
    monkeypatch.chdir(tmp_path)
    Path("output").mkdir()
    Path("output/sweep.csv").touch()
    status, out, err = furuta(*arguments.split())
    assert status in (1, 2)
    assert out == ""
    assert reason in err
    assert len(err.strip().splitlines()) == 1


def test_a_name_that_means_several_parameters(furuta: Any) -> None:
    """It says which ones it has set; one that means one parameter does not."""
    setting = "simulate --seconds 1 --set alpha0=0.3 --set omega1=7"
    _, _, err = furuta(*setting.split())
    assert err == "alpha0=0.3 set plant.friction.alpha0, friction_observer.alpha0\n"


def test_names_of_running_nodes(furuta: Any, processes: Any) -> None:
    """A node that does not run: those that do. A parameter that a node lacks: the one like it."""
    processes.ready_node("controller")
    for arguments, reason in (
        ("set kontroller omega1=7", "no node kontroller answers (waited 5 s); nodes are /contr"),
        ("get controller omgea1", "controller has no parameter omgea1; did you mean omega1"),
        ("set controller omgea1 7", "controller has no parameter omgea1; did you mean omega1"),
        ("get controller alpha", "controller has no parameter alpha; did you mean model.alpha"),
    ):
        status, _, err = furuta("param", *arguments.split())
        assert status == 1
        assert reason in err


def test_a_new_directory_is_reported(furuta: Any, tmp_path: Path) -> None:
    """Once, when it is made."""
    arguments = ("simulate", "--seconds", "1", "--json", "--out", tmp_path / "new" / "run.csv")
    status, _, err = furuta(*arguments)
    assert (status, err) == (0, f"note: made the directory {tmp_path / 'new'}\n")
    assert furuta(*arguments)[2] == ""


@pytest.mark.parametrize(
    ("name", "known", "end"),
    [
        ("omgea1", ["zeta1", "omega1"], "; did you mean omega1?"),
        ("LuGre", ["dahl", "lugre"], "; did you mean lugre?"),
        ("alpha0", ["friction.alpha0", "seed"], "; did you mean friction.alpha0?"),
        ("model.sigma0", ["friction.sigma0"], "; did you mean friction.sigma0?"),
        ("quartz", ["friction.alpha0", "seed"], ""),
    ],
)
def test_suggestion(name: str, known: list[str], end: str) -> None:
    """Letters in disorder, capitals, and parts of dotted names."""
    assert suggestion(name, known) == end
