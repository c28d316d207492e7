"""The command line as a user meets it: results, exit status, one-line errors."""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from click.testing import CliRunner

from furuta.studies.tuning.plan import MIN_SECONDS, TuningPlan
from furuta_bringup import main
from furuta_bringup.verbs import demo

GOOD_FILE = """
/**:
  ros__parameters:
    sample_time: 0.002
plant:
  ros__parameters:
    friction: {alpha0: 0.3, alpha1: 0}
"""


def commands(command: click.Command, path: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """The path of a command and of all its subcommands."""
    yield path
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            subcommand = command.get_command(context, name)
            assert subcommand is not None
            yield from commands(subcommand, (*path, name))


# ``hw emulate`` hands its arguments, --help too, to the executable rig_emulator.
WITH_HELP = [path for path in commands(main.furuta, ()) if path != ("hw", "emulate")]


@pytest.mark.parametrize("path", WITH_HELP, ids=" ".join)
def test_every_command_has_help(path: tuple[str, ...]) -> None:
    """``--help`` of every verb and subcommand shows its usage."""
    done = CliRunner().invoke(main.furuta, [*path, "--help"], prog_name="furuta")
    assert done.exit_code == 0, done.output
    assert done.output.startswith(" ".join(("Usage: furuta", *path)))


# The help of compare names its candidates, which the compensators make.
LIGHT = [verb for verb in main.VERBS if verb != "compare"]
SLOW = {"matplotlib", "scipy.optimize", "scipy.signal", "scipy.interpolate", "scipy.stats"}
SLOW |= {"scipy.io", "rosbags", "control", "pyarrow", "rclpy", "rich"}


@pytest.mark.parametrize(
    ("runs", "never"),
    [
        ([["--help"], *([verb, "--help"] for verb in LIGHT)], SLOW | {"numba", "numpy", "scipy"}),
        ([["simulate", "--seconds", "0.01"]], SLOW),
    ],
    ids=["help", "runs"],
)
def test_a_verb_loads_only_what_it_uses(runs: list[list[str]], never: set[str]) -> None:
    """In a process of its own; help loads no numerical code at all."""
    code = f"""
import sys
from furuta_bringup.main import furuta
for arguments in {runs!r}:
    furuta.main(arguments, "furuta", standalone_mode=False)
print(*sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not set(done.stdout.splitlines()[-1].split()) & never


def test_demo_end_to_end(furuta: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The demo at reduced length: JSON, figure, bag and summary agree, and compensation helps."""
    monkeypatch.setattr(demo, "PLAN", TuningPlan(MIN_SECONDS))
    out_dir = tmp_path / "demo"
    status, out, err = furuta(
        "demo", "--seconds", "8", "--set", "sample_time=0.002", "--out", out_dir, "--json"
    )
    assert status == 0, err
    result = json.loads(out)
    assert result == json.loads((out_dir / "summary.json").read_text().replace("NaN", "null"))
    names = [run["compensation"] for run in result["runs"]]
    assert names == ["none", "coulomb", "lugre", "tuned", "recommended"]
    assert {run["samples"] for run in result["runs"]} == {4000}
    none, *compensated = (run["phi_peak_to_peak_rad"] for run in result["runs"])
    assert 0.45 < none < 0.54
    assert max(compensated) < 0.25 * none
    assert result["tuned_parameters"]["alpha0"] == pytest.approx(0.21, rel=0.02)
    assert Path(result["figure"]).stat().st_size > 10_000
    assert list(Path(result["bag"]).glob("*.mcap"))
    # A second demo may take the place of the first, but of nothing else.
    (Path(result["bag"]) / "thesis.txt").write_text("three years of work")
    status, _, err = furuta("demo", "--seconds", "8", "--out", out_dir)
    assert status == 1
    assert "thesis.txt" in err
    assert (Path(result["bag"]) / "thesis.txt").exists()


def test_simulate(furuta: Any, tmp_path: Path) -> None:
    series = tmp_path / "run.npz"
    status, out, err = furuta(
        "simulate", "--ideal-sensors", "--seconds", "30", "--out", series, "--json"
    )
    assert status == 0, err
    result = json.loads(out)
    assert result["phi_peak_to_peak_rad"] == pytest.approx(0.5106, rel=0.01)
    assert result["steps"] == 30_000
    assert not result["fell"]
    assert np.load(series)["state"].shape == (30_000, 4)


def test_completion(furuta: Any, monkeypatch: Any) -> None:
    """What the shell asks after ``furuta li`` and the tab key."""
    monkeypatch.setenv("_FURUTA_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "furuta li")
    monkeypatch.setenv("COMP_CWORD", "1")
    assert furuta()[:2] == (0, "plain,linearize\nplain,limit-cycle\n")


def test_reset(furuta: Any, processes: Any, request: pytest.FixtureRequest) -> None:
    """A running plant answers; without one there is one line."""
    processes.ready_node("plant", "clock:=lockstep")
    status, out, err = furuta("reset", "--json")
    assert status == 0, err
    assert "initial state" in json.loads(out)["message"]
    request.getfixturevalue("impatient")
    status, _, err = furuta("reset", "--namespace", "elsewhere")
    assert status == 1
    assert err.strip() == (
        "error: no node plant answers (waited 1 s); in other namespaces: /plant (--namespace)"
    )


def test_simulate_explicit_feedback(furuta: Any) -> None:
    """``--feedback`` takes u = l·x: the gain of pole placement with the sign turned."""
    _, out, _ = furuta("linearize", "--json")
    feedback = [str(-gain) for gain in json.loads(out)["L"]]
    runs = [
        json.loads(furuta("simulate", "--seconds", "5", "--json", *extra)[1])
        for extra in ([], ["--feedback", *feedback])
    ]
    for run in runs:
        run.pop("wall_seconds")
    assert runs[0] == runs[1]


def test_the_mode_off_is_a_word(furuta: Any) -> None:
    """``--set mode=off`` means 0 V, although YAML reads ``off`` as false."""
    options = ("simulate", "--seconds", "1", "--ideal-sensors", "--json")
    off, disabled, balanced = (
        json.loads(furuta(*options, *extra)[1])
        for extra in (["--set", "mode=off"], ["--set", "enabled=false"], [])
    )
    for run in (off, disabled, balanced):
        run.pop("wall_seconds")
    assert off == disabled != balanced


def test_linearize(furuta: Any) -> None:
    """The rig's identified numbers and the poles asked for."""
    _, out, _ = furuta("linearize", "--json")
    result = json.loads(out)
    assert result["A"][1][2] == pytest.approx(-11)
    assert result["A"][3][2] == pytest.approx(33)
    assert result["B"] == pytest.approx([0, 45, 0, -29])
    wanted = np.sort_complex(np.roots(np.polymul([1, 9.8, 49], [1, 7, 25])))
    got = [complex(*pole) for pole in result["closed_loop_poles"]]
    np.testing.assert_allclose(np.sort_complex(got), wanted, atol=1e-9)


def test_parameter_file_reaches_the_run(furuta: Any, tmp_path: Path) -> None:
    """A ROS parameter file with a wildcard and a node; --set goes over it."""
    file = tmp_path / "rig.yaml"
    file.write_text(GOOD_FILE)
    common = ("simulate", "--json", "--seconds", "20", "--ideal-sensors", "--params", file)
    by_file = json.loads(furuta(*common)[1])
    assert by_file["steps"] == 10_000
    over = json.loads(furuta(*common, "--set", "plant.friction.alpha0=0.21")[1])
    assert over["phi_peak_to_peak_rad"] < 0.8 * by_file["phi_peak_to_peak_rad"]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ("simulate --set sigma0=-1", "sigma0 must be 0.001 to 1e+06 V/rad, given -1"),
        ("simulate --set gamma=0.0203544", "integration steps"),
        ("simulate --params missing.yaml", "cannot read parameter file missing.yaml"),
        ("simulate --out /dev/null/run.npz", "/dev/null/run.npz"),
        ("run --plant hardware", "no port given"),
        ("run --plant hardware --port mock --lockstep", "has its own clock"),
        ("run --plant hardware --port /dev/nothing", "cannot open /dev/nothing"),
        ("hw rig nobody", "no rig nobody; rigs are"),
        ("hw check --port /dev/nothing", "cannot open /dev/nothing"),
        ("hw friction --port mock --arm-range 0.2", "arm range must be at least"),
        ("node run furuta_sim plane", "it has plant"),
        ("param defaults observer", "no node observer"),
        ("linearize --nyquist --feedback nan 1 1 1", "four finite numbers"),
        ("linearize --figure-4 --feedback 1 1 1 1", "cannot be combined"),
        ("linearize --out x.png", "--out needs --nyquist"),
        ("limit-cycle --predict --feedback 1 inf 1 1", "four finite numbers"),
        ("limit-cycle --feedback 0 7 60 20 --out x.png", "no limit cycle"),
        ("limit-cycle --feedback 0 0 0 0", "does not stabilise"),
        ("limit-cycle --release 0", "--release must not be 0"),
        ("limit-cycle --over omega1=1:2 --over omega1=1:2", "two different parameters"),
        ("limit-cycle --over omega1=-2:-1 --over zeta1=0:1", "omega1 must be"),
        ("limit-cycle --over omega1=1:2 --predict", "not with --predict"),
        ("run --processes --priority 10", "--processes cannot be combined"),
        ("tune --seconds 20 --json", "needs at least"),
        ("tune --running", "no node"),
        ("tune --set method=lowpass --json", "must observe the friction"),
        ("tune --set enabled=false --json", "restored the initial parameters"),
        ("tune --running --set seed=1", "--running cannot be combined"),
        ("swing-up --rig nobody", "no rig nobody"),
        ("swing-up --rig paper", "potentiometer_range must be at least"),
        ("swing-up --set estimator.method=kalman", "whole_circle"),
        ("compare --truths --rigs 5", "--rigs has no effect on the named rigs"),
        ("compare --candidate a=alpha0=0.1:0.3", "needs --tune-budget"),
        ("compare --candidate a=plant.seed=1", "only the plant"),
        ("compare --out mine.csv", "already exists"),
        ("sweep alpha0=0.1:0.2 --out a.txt", ".csv"),
        pytest.param(
            *("sweep alpha0=0.1:0.2 --scheduler tcp://127.0.0.1:9", "no Dask scheduler"),
            marks=pytest.mark.long,
        ),
        ("sweep sigma1=1e9,2e9", "no run is possible"),
    ],
)
def test_bad_input_is_one_line(
    furuta: Any, impatient: Any, tmp_path: Path, monkeypatch: Any, arguments: str, reason: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.csv").write_text("mine")
    status, out, err = furuta(*arguments.split())
    assert status in (1, 2)
    assert out == ""
    assert reason in err
    assert len(err.strip().splitlines()) == 1
    assert Path("mine.csv").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["simulate", "--no-such-option"], "No such option"),
        (["simulat"], "No such command 'simulat'. Did you mean 'simulate'?"),
        (["simulate", "--law", "glue"], "'glue' is not one of 'coulomb', 'stiction'"),
        (["bag", "export", "bag", "--out", "t.xlsx"], "t.xlsx does not end in .csv, .parquet"),
        (["plot", "run.csv"], "Missing option '--out'"),
        (["param", "set", "plant", "--sede", "1"], "expected NAME VALUE"),
        (["simulate", "--seconds", "nan"], "'--seconds': nan is not a finite number"),
        (["run", "--namespace", "1st"], "'--namespace': a namespace has letters"),
        (["simulate", "--out", "run.txt"], "'--out': run.txt does not end in .csv, .parquet"),
        (["identify", "log.csv", "--zero", "left"], "'--zero': 'left' is not one of auto"),
        (["bag", "replay", "bag", "--remap", "a:=b:=c"], "'--remap': 'a:=b:=c' is not FROM:=TO"),
        (["hw", "check", "--port", "mock", "--seconds", "nan"], "'--seconds': nan is not a finite"),
        (["param", "list", "two words"], "'two words' is not a node name such as plant"),
    ],
)
def test_wrong_usage_is_status_2(arguments: list[str], reason: str) -> None:
    """Unknown verbs and options, and numbers out of the range that the message names."""
    done = CliRunner().invoke(main.furuta, arguments)
    assert done.exit_code == 2
    assert reason in done.output


@pytest.mark.parametrize("group", ["", "bag", "export", "hw", "node", "param"])
def test_no_arguments_show_the_help(furuta: Any, group: str) -> None:
    """On standard error, as wrong usage, with every version of click."""
    status, out, err = furuta(*group.split())
    assert (status, out) == (2, "")
    assert err.startswith(f"Usage: furuta {group}".rstrip())
    assert "\nCommands:\n" in err or "\nVerbs:\n" in err


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--params-file", "missing.yaml"], "missing.yaml"),
        (["-p", "model.alpha:=.nan"], "alpha must be finite"),
    ],
)
def test_node_refuses_bad_start(processes: Any, arguments: list[str], reason: str) -> None:
    """An executable says why it does not start, without a traceback."""
    status, _, err = processes.run("node", "run", "furuta_sim", "plant", "--ros-args", *arguments)
    assert status == 1
    assert reason in err.splitlines()[-1]
    assert "Traceback" not in err


def test_param_verbs(furuta: Any, processes: Any) -> None:
    """Set, get and list on a running node, as ``ros2 param`` does."""
    processes.ready_node("friction_observer")
    assert furuta("param", "set", "friction_observer", "sigma0", "90")[0] == 0
    status, out, _ = furuta("param", "get", "friction_observer", "sigma0")
    assert (status, out.strip()) == (0, "90.0")
    for assignments, reason in (
        (("sigma0=-1", "alpha0=0.3"), "sigma0"),
        (("sigma_0", "90"), "friction_observer has no parameter sigma_0"),
        (("sigma0", "200mV"), "sigma0 must be a number without a unit, given '200mV'"),
    ):
        status, _, err = furuta("param", "set", "friction_observer", *assignments)
        assert status == 1
        assert reason in err
        assert len(err.strip().splitlines()) == 1
    assert furuta("param", "set", "friction_observer", "observer_gain", "-0.1")[0] == 0
    values = json.loads(furuta("param", "list", "friction_observer", "--json")[1])
    assert (values["sigma0"], values["alpha0"]) == (90.0, 0.21)
    assert values["observer_gain"] == -0.1
    # On a loaded machine discovery can take longer than the list waits.
    lists = (json.loads(furuta("node", "list", "--json")[1])["nodes"] for _ in range(5))
    assert any("/friction_observer" in nodes for nodes in lists)
