"""The command line as a user meets it: results, exit status, one-line errors."""

import json
import subprocess
import sys
from io import BytesIO, TextIOWrapper
from pathlib import Path
from typing import Any, cast

import click
import pytest
from processes.conftest import commands

from furuta_bringup import main
from furuta_bringup.graph.processes import executable

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


def test_demo_end_to_end(furuta: Any, answer: Any, tmp_path: Path) -> None:
    """The demo at reduced length: JSON, figure, bag and summary agree, and compensation helps."""
    out_dir = tmp_path / "demo"
    result = answer("demo", "--seconds", 8, "--set", "sample_time=0.002", "--out", out_dir)
    assert result == json.loads((out_dir / "summary.json").read_text().replace("NaN", "null"))
    names = [run["compensation"] for run in result["runs"]]
    assert names == ["none", "coulomb", "lugre", "tuned", "recommended"]
    assert {run["samples"] for run in result["runs"]} == {4000}
    none, *compensated = (run["phi_peak_to_peak_rad"] for run in result["runs"])
    assert 0.45 < none < 0.54
    assert max(compensated) < 0.25 * none
    assert result["tuned_parameters"]["sigma1"] > 0.0
    assert Path(result["figure"]).stat().st_size > 10_000
    assert list(Path(result["bag"]).glob("*.mcap"))
    # A second demo may take the place of the first, but of nothing else.
    (Path(result["bag"]) / "thesis.txt").write_text("three years of work")
    status, _, err = furuta("demo", "--seconds", "8", "--out", out_dir)
    assert status == 1
    assert "thesis.txt" in err
    assert (Path(result["bag"]) / "thesis.txt").exists()


# One line each; the true reason in it. Status 2 is wrong usage.
FAILED = {
    "simulate --set sigma0=-1": "sigma0 must be 0.001 to 1e+09 V/rad, given -1",
    "simulate --params missing.yaml": "cannot read parameter file missing.yaml",
    "simulate --rig Papr": "did you mean paper?",
    "simulate --rig qube": "did you mean qube_servo_2?",
    "simulate --rig my_rig.yml": "no rig file my_rig.yml",
    "simulate --set alpha0=21mV": "must be a number, given '21mV'; give it without a unit",
    "simulate --set alpha0=0,3": "given '0,3'; write a decimal point, not a comma",
    "demo --out /proc/x": "cannot make the bag /proc/x/unfinished/bag",
    "simulate --compensation Lugre": "given 'Lugre'; did you mean lugre?",
    "simulate --compensation lugre --set compensation=none": "--compensation sets",
    "limit-cycle --law dahl --set plant.friction.law=lugre": "--law sets plant.friction.law",
    "limit-cycle --over omega1=-2:-1 --over omega2=2:3": "no point of the map is possible: ",
    "simulate --feedback 10 4 60 20 --set omega1=9": "leave out omega1, or it",
    "limit-cycle --over law=1:2": "law is not a number",
    "run --plant hardware": "no port given",
    "run --lockstep --record /proc/x": "cannot make the bag /proc/x: /proc/x: No such file",
    "run --lockstep --record /dev/null": "/dev/null already exists; name another directory",
    "hw check --port /dev/nothing": "cannot open /dev/nothing: No such file or directory; ",
    "param defaults observer": "; did you mean friction_observer?",
    "linearize --nyquist --feedback nan 1 1 1": "feedback[0] must be a finite number",
    "limit-cycle --over omega1=1:2 --over omega1=1:2": "two different parameters",
    "tune --running": "no node",
    "tune --set enabled=false --json": "the initial parameters are restored",
    "compare --out mine.csv": "already exists",
    "sweep sigma1=1e9,2e9": "no run is possible",
    "identify none.csv": "no recording",
}
MISUSED = {
    "simulat": "No such command 'simulat'; did you mean simulate?",
    "simulate --second 3": "No such option '--second'; did you mean --seconds? (see",
    "bag exprt x": "No such command 'exprt'; did you mean export?",
    "simulate --seconds 0,5": "'0,5' is not a number; write a decimal point, not a comma",
    "view --lockstep": "options of furuta run follow after --: furuta view -- --lockstep",
    "view --rig paper": "options of furuta run follow after --: furuta view -- --rig NAME|FILE",
    "axis --pid 1,2,0": "requires 3 arguments, separated by blanks (see furuta axis",
    "axis --counts many --pid 1 2 0": "such as 4096 or 1000/mm",
    "identify x --body axis --lead 5": "'5' is not a length with its unit, such as 10mm or 0.01m",
    "simulate --seconds 10s": "'10s' is not a number; give it without a unit",
    "simulate --law LuGre": "'lugre', 'dahl', 'maxwell_slip'; did you mean lugre?",
    "run --namespace 1st": "'--namespace': a namespace has letters",
    "demo --out mine.csv": "'mine.csv' is a file",
    "bag replay bag --remap a:=b:=c": "'--remap': 'a:=b:=c' is not FROM:=TO",
    "param set plant --sede 1": "expected NAME VALUE",
    "axis --inertia 1 --friction alpha0=1": "give FILE, or --pid, or --cascade",
}


@pytest.mark.parametrize(
    ("expected", "command", "reason"),
    [(1, *each) for each in FAILED.items()] + [(2, *each) for each in MISUSED.items()],
)
def test_bad_input_is_one_line(
    *, furuta: Any, impatient: Any, tmp_path: Path, monkeypatch: Any, expected: int, command: str,
    reason: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    Path("mine.csv").write_text("mine")
    status, out, err = furuta(*command.split())
    assert (status, out, len(err.splitlines())) == (expected, "", 1), err
    assert reason in err
    assert Path("mine.csv").read_text() == "mine"


@pytest.mark.parametrize("encoding", ["cp1252", "cp437", "latin-1", "cp932", "utf-8"])
def test_every_encoding_of_the_output_has_all_texts(
    encoding: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """It spells what it lacks; a parameter file is in UTF-8, as it is read again."""
    for verb in (["linearize"], *([verb, "--help"] for verb in main.VERBS)):
        text = printed(monkeypatch, encoding, *verb).decode(encoding)
        assert "Usage" in text or "poles" in text
        assert "\\u" not in text
    assert "G(jomega)" in printed(monkeypatch, "cp1252", "limit-cycle", "--help").decode("cp1252")
    file = tmp_path / "parameters.yaml"
    file.write_bytes(printed(monkeypatch, encoding, "param", "defaults", "controller"))
    given = file.read_bytes().decode("utf-8")
    file.write_bytes(given.encode("utf-16"))  # as a shell of Windows redirects it
    printed(monkeypatch, encoding, "linearize", "--params", str(file))


def printed(monkeypatch: pytest.MonkeyPatch, encoding: str, *arguments: str) -> bytes:
    """What a verb writes to a file of this encoding; it succeeds."""
    stream = TextIOWrapper(BytesIO(), encoding)
    monkeypatch.setattr(sys, "stdout", stream)
    monkeypatch.setattr(sys, "argv", ["furuta", *arguments])
    with pytest.raises(SystemExit) as ended:
        main.run_verb()
    assert not ended.value.code
    stream.flush()
    return cast("BytesIO", stream.buffer).getvalue()


def test_a_name_that_means_several_parameters(furuta: Any) -> None:
    """It says which ones it has set; one that means one parameter does not."""
    setting = "simulate --seconds 1 --set alpha0=0.3 --set omega1=7"
    _, _, err = furuta(*setting.split())
    assert err == "alpha0=0.3 set plant.friction.alpha0, friction_observer.alpha0\n"


def test_a_fall_is_said(furuta: Any) -> None:
    """First: what is measured of a pendulum that lies says nothing."""
    _, out, _ = furuta("simulate", "--seconds", "5", "--set", "plant.friction.alpha0=21")
    first, _, table = out.replace("\n", " ").partition("mean nothing.")
    assert first.startswith("The pendulum fell after 0.862 s: alpha0, 21 V, exceeds the drive's 10")
    assert "fell                     yes" in table


@pytest.mark.parametrize(("names", "command"), list(commands(main.furuta)), ids=str)
def test_help_fits_a_terminal(names: tuple[str, ...], command: click.Command) -> None:
    """Of 80 columns: nothing is cut, and a command is called so."""
    context = click.Context(command, info_name=" ".join(names), terminal_width=80)
    usage, *lines = command.get_help(context).splitlines()
    assert usage.startswith("Usage: ")
    assert not [line for line in lines if len(line) > 80 or line.endswith("...")]
    assert "verb" not in " ".join(lines).lower()
    assert not isinstance(command, click.Group) or "Commands:" in lines


def test_node_refuses_bad_start(processes: Any) -> None:
    """An executable says why it does not start, without a traceback."""
    plant = executable("furuta_sim", "plant")
    process = processes.start(plant, "--ros-args", "-p", "model.alpha:=.nan")
    _, err = process.communicate(timeout=120)
    assert process.returncode == 1
    assert "alpha must be finite" in err.splitlines()[-1]
    assert "Traceback" not in err


def test_param_verbs(furuta: Any, processes: Any) -> None:
    """Set, get and list on a running node, as ``ros2 param`` does."""
    processes.ready_node("friction_observer")
    status, out, _ = furuta("param", "set", "friction_observer", "sigma0", "90")
    assert (status, out) == (0, "friction_observer.sigma0 = 90.0\n")
    status, out, _ = furuta("param", "get", "friction_observer", "sigma0")
    assert (status, out.strip()) == (0, "90.0")
    for assignments, reason in (
        (("sigma0=-1", "alpha0=0.3"), "sigma0"),
        (("sample_time", "0.01"), "fixed at start: furuta run --set sample_time=0.01"),
        (("sigma_0", "90"), "friction_observer has no parameter sigma_0; did you mean sigma0"),
        (("sigma0", "200mV"), "sigma0 must be a number, given '200mV'; give it without a unit"),
    ):
        status, _, err = furuta("param", "set", "friction_observer", *assignments)
        assert status == 1
        assert reason in err
        assert len(err.strip().splitlines()) == 1
    assert furuta("param", "set", "friction_observer", "observer_gain", "-0.1")[0] == 0
    values = json.loads(furuta("param", "list", "friction_observer", "--json")[1])
    assert (values["sigma0"], values["alpha0"]) == (90.0, 0.21)
    assert values["observer_gain"] == -0.1
