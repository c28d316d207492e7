"""Every public function over many situations: its results print, draw, copy and agree."""

import copy
import inspect
import json
import pickle
import re
import subprocess
import sys
import warnings
from collections.abc import Callable, Container, Iterable
from dataclasses import fields, is_dataclass
from functools import cache, cached_property, partial
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest

import furuta
from furuta import results
from furuta.results.text import WIDTH
from furuta_model.friction.names import LAWS

FOLDER = TemporaryDirectory()
ROOT = Path(__file__).resolve().parents[3]
LIBRARY = ROOT / "docs" / "library.md"
# Situations of the pendulum's loop: parameters, and seconds of a run. The first run in `make test`.
QUICK_LOOPS: dict[str, tuple[dict[str, Any], float]] = {
    "paper": ({}, 12.0),
    "no friction": ({"plant.friction.alpha0": 0.0, "plant.friction.alpha1": 0.0}, 12.0),
    "fell": ({"plant.friction.alpha0": 21.0}, 5.0),
    "between rests": ({"zeta1": 1.25}, 12.0),
    "off": ({"enabled": False}, 3.0),
    "one sample": ({}, 1e-3),
}
LOOPS = QUICK_LOOPS | {
    "unbounded": ({"gain": [0.0, 0.0, -60.0, -20.0], "friction.law": "coulomb"}, 12.0),
    "turns": ({"gain": [0.0, -7.0, -60.0, -20.0]}, 12.0),
    "at rest": ({"initial.theta": 0.0, "sensors.ideal": True}, 12.0),
    "compensated": ({"compensation": "recommended"}, 12.0),
    "unstable": ({"gain": [0.0, 0.0, 60.0, 20.0]}, 3.0),
    "two samples": ({}, 2e-3),
    "slow samples": ({"sample_time": 0.02}, 5.0),
    "no sensors": ({"sensor_faults.missing": 1.0}, 3.0),
    "elastic": ({"coupling.frequency": 30.0}, 5.0),
    "falls at once": ({"plant.friction.law": "stribeck", "stribeck_velocity": 1e-6}, 6.0),
    **{f"law {law}": ({"plant.friction.law": law}, 6.0) for law in LAWS},
}
OF_LOOPS: dict[str, Callable[[Any, float], Any]] = {
    "simulate": furuta.simulate,
    "measure": furuta.measure,
    "limit_cycle": lambda loop, _: furuta.limit_cycle(loop),
    "predict_cycles": lambda loop, _: furuta.predict_cycles(loop),
    "linear_model": lambda loop, _: furuta.linear_model(loop, nyquist=True, passivity=True),
    "sweep": lambda loop, s: furuta.sweep({"alpha0": [0.1, 0.2], "omega1": [7.0]}, loop, min(s, 3)),
    "series": lambda loop, s: furuta.simulate(loop, min(s, 0.1)).series(),
}
SLIDING = furuta.Friction(alpha0=0.1, alpha1=0.05, viscous=0.02, stribeck_velocity=0.05)
SMOOTH = furuta.Friction(alpha0=0.0, alpha1=0.0)
AXES: dict[str, tuple[furuta.Axis, Any, float]] = {
    "hunts": (furuta.Axis(0.01, SLIDING, "stiction"), furuta.Pid(2.0, 6.0, 0.12), 0.0),
    "steady": (furuta.Axis(0.01, SLIDING, "stribeck"), furuta.Cascade(10.0, 0.3, 1.0), 3.0),
    "rests": (furuta.Axis(0.01, SLIDING, "stribeck"), furuta.Pid(2.0, 0.0, 0.12), 0.0),
    "unbounded": (furuta.Axis(0.01, SLIDING, "coulomb"), furuta.Pid(2.0, 600.0, 0.0), 0.0),
    "frictionless": (furuta.Axis(0.01, SMOOTH, "coulomb"), furuta.Pid(2.0, 6.0, 0.2), 0.0),
    "backwards": (furuta.Axis(0.01, SLIDING, "stribeck"), furuta.Pid(2.0, 6.0, 0.12), -0.02),
    "no gains": (furuta.Axis(0.01, SLIDING, "stribeck"), furuta.Pid(0.0), 0.0),
}
METRES = ("m", "N")
TIME = 2e-3 * np.arange(4000)
MOVES = 0.6 * np.sin(4.4 * TIME) + 0.2 * np.sin(11.9 * TIME)
PATHS = {
    "both ways": MOVES,
    "one way": 5.0 * TIME + 0.5 * MOVES,
    "rests": 0.0 * TIME,
    "steps": 0.3 * np.sign(np.sin(2.0 * TIME)) + 0.02 * TIME,
}


def loop_of(name: str) -> tuple[Any, float]:
    """The loop of a situation, and the seconds of its run."""
    values, seconds = LOOPS[name]
    return furuta.make_loop(values), seconds


def chosen(names: Iterable[str], quick: Container[str]) -> list[Any]:
    """Parameters of a test; those that are not quick are long."""
    return [pytest.param(name, marks=() if name in quick else pytest.mark.long) for name in names]


def joint_of(level: float = 1.0) -> Any:
    """A linear loop that hunts."""
    a = np.array([[-1.0, 4.0, 1.5], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    first, friction = np.eye(3)[0], furuta.Friction(alpha0=level, alpha1=0.5)
    return furuta.friction_joint((a, first, first), friction, "stiction")


def of_pendulum(seconds: float = 8.0, driven: bool = True, **values: Any) -> Any:
    """What a recording of a pendulum tells."""
    run = furuta.simulate(furuta.make_loop(values), seconds)
    drive = (run.time, run.command) if driven else (np.empty(0), np.empty(0))
    recording = furuta.Recording("run", run.time, run.measurement[:, :4], *drive)
    return furuta.identify(recording, furuta.PendulumBody(laws=driven))


@cache
def recorded(path: str, law: str) -> Any:
    """A recorded axis."""
    axis, moves = furuta.Axis(0.01, SLIDING, law), PATHS[path]
    given: dict[str, Any] = {"reference": moves, "counts": 2**17, "sample_time": 2e-3}
    return furuta.simulate_axis(axis, furuta.Pid(4.0, 6.0, 0.2), seconds=8.0, **given).recording


@cache
def fit(path: str, law: str = "coulomb", units: tuple[str, str] = ("rad", "N m")) -> Any:
    """What a recorded axis tells."""
    return furuta.identify(recorded(path, law)._replace(units=units), "axis")


CASES: dict[str, Callable[[], Any]] = {}
QUICK: set[str] = set()


def add(case: str, quick: bool, make: Callable[..., Any], *given: Any, **named: Any) -> None:
    """Add function and situation, whether it is quick, and what makes the result."""
    CASES[case] = partial(make, *given, **named)
    QUICK.update([case] * quick)


def of_loop(function: str, name: str) -> Any:
    return OF_LOOPS[function](*loop_of(name))


def compared(name: str, keep: bool, runs: bool) -> Any:
    given: dict[str, Any] = {"seconds": 3.0, "pushes": [2.0] * keep, "keep_runs": keep}
    found = furuta.compare(loop_of(name)[0], ["none", "lugre"], 2, **given)
    return found.runs if runs else found


def of_axes(*paths: str) -> Any:
    return furuta.identify({path: recorded(path, "stiction") for path in paths}, "axis")


def read_back(file: Path) -> Any:
    furuta.simulate(seconds=0.1).write(file)
    return furuta.load_series(file)


for each, function in product(LOOPS, OF_LOOPS):
    add(f"{function}: {each}", each in QUICK_LOOPS, of_loop, function, each)
for each in ("paper", "fell", "compensated", "unbounded", "no sensors"):
    add(f"tune: {each}", False, lambda name: furuta.tune(loop_of(name)[0], 60.0), each)
    for keep, runs in product((True, False), repeat=2):
        add(f"compare: {each}, {keep}, {runs}", each == "paper", compared, each, keep, runs)
add("sweep: of a word", True, furuta.sweep, {"compensation": ["none", "lugre"]}, None, 3.0)
add("sweep: impossible", True, furuta.sweep, {"plant.model.gamma": [1.0, 2.0]})
add("sweep: not kept", True, furuta.sweep, {"seed": [1]}, None, 1.0, keep_runs=False)
add("random_rigs: two", True, furuta.random_rigs, 2)
add("random_rigs: waves", True, furuta.random_rigs, 2, disturbances=["cogging"])
add("swing_up: one", False, furuta.swing_up, 1)
add("swing_up: never", False, furuta.swing_up, 1, {"voltage_limit": 0.1}, knocks=True)
add("cycle_branch: viscous", False, furuta.cycle_branch, None, "viscous", 0.0, 0.02)
add("cycle_branch: one value", True, furuta.cycle_branch, None, "viscous", 0.0, 0.0)
add("cycle_branch: joint", True, furuta.cycle_branch, joint_of, "level", 0.9, 1.1, value=1.0)
add("limit_cycle: joint", True, lambda: furuta.limit_cycle(joint_of()))
add("predict_cycles: joint", True, lambda: furuta.predict_cycles(joint_of()))
omegas: dict[str, Any] = {"omega1": [6, 7], "omega2": [5]}
add("cycle_map: one", True, furuta.cycle_map, None, omegas | {"omega1": [7]})
add("cycle_map: two", False, furuta.cycle_map, None, omegas)
smooth = {"alpha0": [0.0, 0.1], "alpha1": [0.0]}
add("cycle_map: none", False, furuta.cycle_map, None, smooth, law="coulomb")
multisine = {"excitation.kind": "multisine", "excitation.amplitude": 1.0}
add("identify: driven", False, of_pendulum, **multisine)
hanging = {"enabled": False, "initial.theta": 2.8, "potentiometer_range": 6.2}
add("identify: free", False, of_pendulum, driven=False, **hanging)
add("MeasuredFriction: levels", True, results.MeasuredFriction, 0.2, 0.2, 0.3, 0.3, 0.0)
for each, (axis, gains, speed) in AXES.items():
    few, run = each in ("hunts", "unbounded"), partial(furuta.simulate_axis, axis, gains)
    study = partial(furuta.study_axis, axis, gains, speed=speed)
    add(f"servo_cycle: {each}", True, furuta.servo_cycle, axis, gains, speed)
    add(f"simulate_axis: {each}", few, run, reference=speed, seconds=2.0)
    add(f"simulate_axis: {each}, one sample", few, run, seconds=1e-3)
    add(f"study_axis: {each}", False, study)
    add(f"study_axis: {each}, cycle", few, lambda made: made().cycle, study)
for each, law in product(PATHS, ("coulomb", "stiction", "stribeck")):
    few = (each, law) in (("steps", "stiction"), ("one way", "coulomb"))
    add(f"identify axis: {each}, {law}", few, fit, each, law)
add("identify axis: in m", False, fit, "both ways", units=METRES)
pid, moved = furuta.Pid(2.0, 6.0, 0.12), partial(recorded, "both ways", "coulomb")
add("study_axis: identified", False, lambda: furuta.study_axis(fit("both ways"), pid))
add("study_axis: in m", False, lambda: furuta.study_axis(fit("both ways", units=METRES), pid))
for each in ((), ("rests",), ("steps", "rests")):
    add(f"identify axes: {each}", len(each) < 2, of_axes, *each)
add("identify joint: alone", True, lambda: furuta.identify(moved(), "joint"))
goal = {"command_time": TIME, "command": MOVES}
add("identify servo: both ways", False, lambda: furuta.identify(moved()._replace(**goal), "servo"))
add("export_c: loop", True, furuta.export_c, furuta.Loop(), Path(FOLDER.name))
add("load_series: run", True, read_back, Path(FOLDER.name, "run.csv"))
# What is no result: a rig, text; and what needs the graph.
OTHERS = {"identified_rig", "export_joint", "Rig", "Demo"}


def test_every_function_of_the_documentation_is_here() -> None:
    _, _, text = LIBRARY.read_text(encoding="utf-8").partition("## What there is")
    rows = re.findall(r"^\| (`.*?`) \|", text.partition("These ")[0], re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"\w+", row)}
    here = {case.partition(":")[0] for case in CASES}
    assert len(named) >= 20 and named - OTHERS <= here


def is_refusal(error: BaseException) -> None:
    """One line, without traces of Python."""
    text = str(error)
    assert text and "\n" not in text
    assert not re.search(r"Singular|Traceback|\bnan\b|\binf\b|array\(|np\.|None", text, re.I), text


def is_text(result: Any) -> None:
    """Lines within the width, but for long words, without traces of Python."""
    report = result.report()
    assert str(result) == repr(result) == report and report.strip()
    wide = [line for line in report.splitlines() if len(line) > WIDTH]
    assert all(len(line.split()[-1]) > WIDTH // 2 for line in wide), wide
    shown = report.replace("None is best", "")
    odd = re.search(r"\b(nan|inf|None|True|False|np\.\w+|array|dtype)\b|[{}]", shown)
    assert odd is None, shown[max(0, odd.start() - 60) : odd.end() + 20]


def is_json(result: Any) -> None:
    """JSON without numpy, NaN and infinity; values of a fit are numbers of Python."""
    given = result.to_dict()
    assert json.loads(json.dumps(given, allow_nan=False)) == given
    for name in ("values", "standard_errors"):
        found = getattr(result, name, None)
        if isinstance(found, dict):
            assert {type(each) for each in found.values()} <= {float}, found


def can_be_copied(result: Any) -> None:
    for same in (pickle.loads(pickle.dumps(result)), copy.copy(result), copy.deepcopy(result)):
        assert same.report() == result.report() and type(same) is type(result)


def has_members(result: Any) -> None:
    """Every public name is there; what needs no argument works or is refused."""
    assert not (is_dataclass(result) and {"count", "index"} & {*dir(result)})
    for name in dir(result):
        if name.startswith("_") or name == "plot" or hasattr(dict, name):
            continue
        try:
            value = getattr(result, name)
            if callable(value) and not inspect.isclass(value):
                inspect.signature(value).bind()
                value()
        except furuta.ParameterError as error:
            is_refusal(error)
        except (TypeError, ValueError) as error:
            assert "missing a required" in str(error), f"{name}: {error}"


def is_exported(result: Any) -> None:
    """A table is the same elsewhere, with its units."""
    for library in ("pandas", "xarray") if isinstance(result, results.Table) else ():
        pytest.importorskip(library)
        other = getattr(result, f"to_{library}")()
        for name, values in result.items():
            np.testing.assert_array_equal(np.asarray(other[name]), values)
            units = other.attrs["units"] if library == "pandas" else other[name].attrs
            of = name if library == "pandas" else "units"
            assert units.get(of, "") == result.units.get(name, "")


def is_drawn(result: Any) -> None:
    """It is drawn, on new axes and on given ones, or refused."""
    try:
        axes = np.ravel(result.plot())
        axes[0].figure.canvas.draw()
        assert any(each.has_data() for each in axes)
        own = plt.subplots(len(axes), squeeze=False)[1]
        assert {each.figure for each in np.ravel(result.plot(own))} == {own[0, 0].figure}
        with pytest.raises(furuta.ParameterError, match=rf"has {len(axes)} axes, given"):
            result.plot(plt.subplots(len(axes) + 1)[1])
    except furuta.ParameterError as error:
        is_refusal(error)
    finally:
        plt.close("all")


@pytest.mark.parametrize("case", chosen(CASES, QUICK))
def test_a_result_keeps_its_promises(case: str) -> None:
    """Without a warning; or it is refused."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            result = CASES[case]()
        except furuta.ParameterError as error:
            is_refusal(error)
        else:
            for kept in (is_text, is_json, can_be_copied, has_members, is_exported, is_drawn):
                kept(result)


@pytest.mark.parametrize("name", chosen(LOOPS, QUICK_LOOPS))
def test_a_quantity_is_the_same_in_every_result(name: str) -> None:
    """Of a run, its measurement, a sweep and a comparison; or none has a value."""
    loop, seconds = loop_of(name)
    seed, same = {"plant.seed": [loop.plant.seed]}, {"compensation": loop.observer.compensation}
    run, outcome = furuta.simulate(loop, seconds), furuta.measure(loop, seconds)
    assert np.any(np.abs(run.state[:, 2]) > 0.5 * np.pi) == outcome.fell
    swept = furuta.sweep(seed, loop, seconds)
    runs = furuta.compare(loop, {"same": same}, seed, seconds=seconds, keep_runs=True).runs
    one = run.to_dict()
    for other in (outcome.to_dict(), *swept.dictionaries(), *runs.dictionaries()):
        assert {key: other[key] for key in one} == one


@pytest.mark.long  # mypy without its cache takes as long as a tenth of the tests
def test_types_of_results_are_known() -> None:
    """In a user's code every field has a type, and a misspelt one is an error."""
    lines, wrong = ["import furuta", "from furuta import results"], []
    for name in results.__all__:
        kind = getattr(results, name)
        own = [each.name for each in fields(kind)] if is_dataclass(kind) else []
        own += [n for n, each in vars(kind).items() if isinstance(each, property | cached_property)]
        if is_dataclass(kind) or issubclass(kind, dict):
            lines += [f"def of_{name}(it: results.{name}) -> None:", "    it.misspelt"]
            lines += [f"    reveal_type(it.{each})" for each in own]
            wrong.append(f'"{name}" has no attribute "misspelt"')
    calls = ["limit_cycle().period_s", "simulate().command", "measure().fell", "tune().before"]
    own_body = "def identified(self, recordings: object, report: object) -> results.Fitted:"
    lines += ["class Mine:", f"    {own_body} raise NotImplementedError"]
    for body in ("'axis'", "'servo'", "furuta.JointBody()", "Mine()"):
        fit = f"identify([], {body})"
        calls += [f"{fit}.conf_int()", f"{fit}.predict", f"{fit}.residual.part"]
    lines += [f"reveal_type(furuta.{call})" for call in calls]
    command = [sys.executable, "-m", "mypy", "--strict", "-c", "\n".join(lines)]
    said = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False).stdout
    assert len(wrong) > 15 and all(each in said for each in wrong), said
    assert f"Found {len(wrong)} errors" in said and 'type is "Any"' not in said, said


@pytest.mark.parametrize("name", ["pandas", "xarray"])
def test_a_library_that_is_missing_is_named(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(furuta.ParameterError, match=f"pip install {name}$"):
        getattr(results.Table(), f"to_{name}")()
