"""The library: what it offers, that it is documented, and that its answers are right."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
import typing
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import furuta
from furuta_model.parameters import About

FUNCTIONS = [name for name in furuta.__all__ if inspect.isfunction(getattr(furuta, name))]
CLASSES = [
    name
    for name in furuta.__all__
    if inspect.isclass(getattr(furuta, name)) and hasattr(getattr(furuta, name), "_fields")
]
# Functions that read nothing and accept every value of their types.
WITHOUT_ERRORS = {"identified_values", "rig_names", "simulated_series"}
# Names of fields and arguments that tell their unit.
UNIT_ENDINGS = ("_rad", "_s", "_v", "_rad_s", "_1_s")


def sections(docstring: str) -> dict[str, str]:
    """The sections of a Google-style docstring by title."""
    parts = re.split(r"^(Args|Returns|Raises):$", inspect.cleandoc(docstring), flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}


def entries(section: str) -> dict[str, str]:
    """The entries ``name: text`` of a section."""
    parts = re.split(r"^    (\w+): ", section, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_function_is_documented(name: str) -> None:
    """Every argument, with a unit if it is a number; the result with units; the errors."""
    function = getattr(furuta, name)
    text = sections(function.__doc__)
    arguments = entries(text.get("Args", ""))
    signature = inspect.signature(function)
    assert list(arguments) == list(signature.parameters)
    for argument, about in signature.parameters.items():
        if "float" in str(about.annotation) or "ndarray" in str(about.annotation):
            assert re.search(r"\[.+\]|\(n,\)|Fraction", arguments[argument]), argument
    returned = signature.return_annotation
    assert returned == "None" or text["Returns"].strip()
    if re.search("float|complex|ndarray", returned):
        assert re.search(r"\[.+\]|\(\w+,.*\)", text["Returns"]), text["Returns"]
    assert ("Raises" in text) == (name not in WITHOUT_ERRORS)


@pytest.mark.parametrize("name", CLASSES)
def test_fields_are_documented(name: str) -> None:
    """Every field has a declaration with its unit, or is named in the docstring."""
    group = getattr(furuta, name)
    hints = typing.get_type_hints(group, include_extras=True)
    for field in group._fields:
        about = getattr(hints[field], "__metadata__", ())
        declared = any(isinstance(note, About) and note.meaning for note in about)
        nested = hasattr(hints[field], "_fields")
        named = re.search(rf"\b{field}\b", group.__doc__) or field.endswith(UNIT_ENDINGS)
        assert declared or nested or named, field


def test_example_of_the_docstring() -> None:
    """The five lines print what the docstring says, and load neither ROS nor matplotlib.

    A notebook thus keeps its own backend of matplotlib.
    """
    lines = (furuta.__doc__ or "").splitlines()
    code = "\n".join(line.removeprefix("    >>> ") for line in lines if ">>> " in line)
    code = code.replace("seconds=60.0", "seconds=0.1") + "; import sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    printed, loaded = done.stdout.strip().splitlines()
    assert printed == lines[-1].strip()
    assert not set(loaded.split()) & {"rclpy", "matplotlib", "click"}


def test_limit_cycle_agrees_with_a_simulation() -> None:
    """The exact motion of the ideal loop is the one that a simulation with ideal sensors has."""
    loop = furuta.make_loop({"sensors.ideal": True})
    cycle, run = furuta.limit_cycle(loop), furuta.measure(loop, 30.0)
    assert cycle.kind == "oscillation"
    assert run.phi_peak_to_peak_rad == pytest.approx(cycle.phi_peak_to_peak_rad, rel=0.01)
    assert run.period_s == pytest.approx(cycle.period_s, rel=0.01)
    period = furuta.trace_cycle(loop, cycle)
    assert period.time[-1] == pytest.approx(cycle.period_s)
    assert np.ptp(period.state[:, 0]) == pytest.approx(cycle.phi_peak_to_peak_rad, rel=1e-3)


def test_closed_forms() -> None:
    """Describing function 4α₀/(πA) of Coulomb friction; poles where they were placed."""
    law = furuta.friction_law("coulomb", furuta.Friction(alpha0=0.3))
    assert furuta.describing_function(2.0, 5.0, law) == pytest.approx(4 * 0.3 / (pi * 2.0))
    pendulum = furuta.FurutaPendulum()
    a, b = furuta.linearize(pendulum)
    gain = furuta.place_poles(pendulum, furuta.DesiredPoles(7.0, 0.7, 5.0, 0.7))
    poles = np.linalg.eigvals(a - np.outer(b, gain))
    assert sorted(np.abs(poles)) == pytest.approx([5.0, 5.0, 7.0, 7.0])


def test_rig_reaches_every_node() -> None:
    """Rigs come by name; their model and sample time are those of the loop."""
    assert {"paper", "qube_servo_2"} <= set(furuta.rig_names())
    rig = furuta.load_rig("qube_servo_2")
    for given in (rig, "qube_servo_2"):
        loop = furuta.make_loop({"plant.friction.alpha0": 0.5}, rig=given)
        assert loop.plant.model == loop.controller.model == rig.model
        assert loop.estimator.sample_time == rig.line.sample_time
        assert loop.plant.friction.parameters.alpha0 == 0.5


def test_series_of_every_format_come_back(tmp_path: Path) -> None:
    """What is written is read to the last bit, with the documented columns."""
    run = furuta.simulate(seconds=0.1)
    series = furuta.simulated_series(run)
    assert set(series) <= set(furuta.COLUMNS)
    assert np.array_equal(series["true_theta_rad"], run.state[:, 2])
    for suffix in (".csv", ".npz", ".mat"):
        furuta.write_series(tmp_path / f"run{suffix}", series)
        again = furuta.load_series(tmp_path / f"run{suffix}")
        assert list(again) == list(series)
        assert all(np.array_equal(again[name], series[name]) for name in series)


def test_recording_of_a_simulation_is_what_its_sensors_measured(tmp_path: Path) -> None:
    """From a table of its series; identification must not see the estimates."""
    run = furuta.simulate(seconds=0.2)
    furuta.write_series(tmp_path / "run.csv", furuta.simulated_series(run))
    recording = furuta.read_recording(tmp_path / "run.csv")
    assert np.array_equal(recording.measured, run.measurement[:, :4], equal_nan=True)
    assert not np.array_equal(recording.measured[:, :3], run.estimate[:, :3])
    assert np.array_equal(recording.command, run.command)
    counts = run.measurement[:, 0] / (2 * pi / 250)
    assert counts == pytest.approx(np.round(counts))
    assert np.all(np.isnan(run.measurement[:, 3]))


def test_tune_improves_the_loop() -> None:
    """The tuned compensation leaves less than none does."""
    messages: list[tuple[str, float]] = []
    result = furuta.tune(report=lambda *message: messages.append(message))
    assert result.after.amplitude < 0.2 * result.uncompensated.amplitude
    assert messages


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda: furuta.make_loop({"alfa0": 0.1}), "did you mean alpha0"),
        (lambda: furuta.make_loop({"alpha0": None}), "must be a number, text or list"),
        (lambda: furuta.make_loop({"alpha0": "much"}), "alpha0 must be"),
        (lambda: furuta.load_rig("nobody"), "no rig nobody; rigs are"),
        (lambda: furuta.make_loop(rig="nobody"), "no rig nobody; rigs are"),
        (lambda: furuta.simulate(seconds=-1.0), "seconds must be above 0 and finite, given -1"),
        (lambda: furuta.simulate(seconds=float("nan")), "seconds must be above 0"),
        (lambda: furuta.measure(settled=0.0), "settled must be above 0 and at most 1, given 0"),
        (lambda: furuta.ideal_loop(feedback=[1, 2]), "feedback must be four finite numbers"),
        (lambda: furuta.ideal_loop(feedback=[-7.69, -1.36, -1.05, -0.504]), "does not stabilise"),
        (lambda: furuta.ideal_loop(law="maxwell_slip"), "not defined for the friction law"),
        (lambda: furuta.friction_law("glue"), "no friction law glue; laws are coulomb"),
        (lambda: furuta.describing_function(0.0, 1.0, furuta.friction_law("lugre")), "above 0"),
        (lambda: furuta.linearize(furuta.FurutaPendulum(gamma=1.0)), "alpha * beta must exceed"),
        (lambda: furuta.trace_cycle(None, furuta.LimitCycle("rest")), "given a rest motion"),
        (lambda: furuta.tune(seconds=1.0), "needs at least"),
        (lambda: furuta.load_series("nothing.csv"), "no file or bag nothing.csv"),
        (lambda: furuta.read_recording("nothing.csv"), "no recording nothing.csv"),
        (lambda: furuta.write_series("run.xlsx", {}), "does not end in .csv, .parquet, .mat, .npz"),
    ],
)
def test_bad_input_is_a_parameter_error(call: Any, reason: str) -> None:
    """One error type, with a message that says what was given and what is allowed."""
    with pytest.raises(furuta.ParameterError, match=re.escape(reason)):
        call()
