"""The library: what it loads, that its answers are right, and its errors."""

import re
import subprocess
import sys
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import furuta


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
    loop = furuta.make_loop({"sensors.ideal": True})
    cycle, run = furuta.limit_cycle(loop), furuta.measure(loop, 30.0)
    assert cycle.kind == "oscillation"
    assert run.phi_peak_to_peak_rad == pytest.approx(cycle.phi_peak_to_peak_rad, rel=0.01)
    assert run.period_s == pytest.approx(cycle.period_s, rel=0.01)
    period = furuta.trace_cycle(loop, cycle)
    assert period.time[-1] == pytest.approx(cycle.period_s)
    assert np.ptp(period.state[:, 0]) == pytest.approx(cycle.phi_peak_to_peak_rad, rel=1e-3)


def test_closed_forms() -> None:
    law = furuta.friction_law("coulomb", furuta.Friction(alpha0=0.3))
    assert furuta.describing_function(2.0, 5.0, law) == pytest.approx(4 * 0.3 / (pi * 2.0))
    pendulum = furuta.FurutaPendulum()
    a, b = furuta.linearize(pendulum)
    gain = furuta.place_poles(pendulum, furuta.DesiredPoles(7.0, 0.7, 5.0, 0.7))
    poles = np.linalg.eigvals(a - np.outer(b, gain))
    assert sorted(np.abs(poles)) == pytest.approx([5.0, 5.0, 7.0, 7.0])


def test_rig_reaches_every_node() -> None:
    assert {"paper", "qube_servo_2"} <= set(furuta.rig_names())
    rig = furuta.load_rig("qube_servo_2")
    for given in (rig, "qube_servo_2"):
        loop = furuta.make_loop({"plant.friction.alpha0": 0.5}, rig=given)
        assert loop.plant.model == loop.controller.model == rig.model
        assert loop.estimator.sample_time == rig.line.sample_time
        assert loop.plant.friction.parameters.alpha0 == 0.5


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


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda: furuta.make_loop({"alfa0": 0.1}), "did you mean alpha0"),
        (lambda: furuta.make_loop({"alpha0": None}), "must be a number, text or list"),
        (lambda: furuta.make_loop(rig="nobody"), "no rig nobody; rigs are"),
        (lambda: furuta.simulate(seconds=-1.0), "seconds must be above 0 and finite, given -1"),
        (lambda: furuta.measure(settled=0.0), "settled must be above 0 and at most 1, given 0"),
        (lambda: furuta.ideal_loop(feedback=[1, 2]), "feedback must be four finite numbers"),
        (lambda: furuta.ideal_loop(feedback=[-7.69, -1.36, -1.05, -0.504]), "does not stabilise"),
        (lambda: furuta.friction_law("glue"), "no friction law glue; laws are coulomb"),
        (lambda: furuta.describing_function(0.0, 1.0, furuta.friction_law("lugre")), "above 0"),
        (lambda: furuta.trace_cycle(None, furuta.LimitCycle("rest")), "given a rest motion"),
        (lambda: furuta.tune(seconds=1.0), "needs at least"),
        (lambda: furuta.read_recording("nothing.csv"), "no recording nothing.csv"),
        (lambda: furuta.write_series("run.xlsx", {}), "does not end in .csv, .parquet, .mat, .npz"),
    ],
)
def test_bad_input_is_a_parameter_error(call: Any, reason: str) -> None:
    with pytest.raises(furuta.ParameterError, match=re.escape(reason)):
        call()
