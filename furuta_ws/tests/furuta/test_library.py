"""The library: what it loads, that its answers are right, and its errors."""

import subprocess
import sys
from math import inf, nan, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import furuta
from furuta_model.parameters import shortened


def test_example_of_the_docstring() -> None:
    """The five lines print what the docstring says, and load only what they use.

    A notebook thus keeps its own backend of matplotlib. scipy.signal takes long to load.
    """
    lines = (furuta.__doc__ or "").splitlines()
    code = "\n".join(line.removeprefix("    >>> ") for line in lines if ">>> " in line)
    code = code.replace("seconds=60.0", "seconds=0.1") + "; import sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    printed, loaded = done.stdout.strip().splitlines()
    assert printed == lines[-1].strip()
    unused = {"rclpy", "matplotlib", "click", "rosbags", "control", "scipy.io", "scipy.signal"}
    unused |= {"scipy.optimize"}
    assert not set(loaded.split()) & unused


def test_linearized_loop_has_the_placed_poles() -> None:
    """Also with viscous friction, of which pole placement knows."""
    given = {"omega1": 9.0, "zeta1": 0.7, "omega2": 5.0, "zeta2": 0.7}
    poles = furuta.linearize(furuta.make_loop(given, rig="qube_servo_2")).poles()
    assert sorted(np.abs(poles)) == pytest.approx([5.0, 5.0, 9.0, 9.0])


def test_recording_of_a_simulation_is_what_its_sensors_measured(tmp_path: Path) -> None:
    """From a table of its series; identification must not see the estimates."""
    run = furuta.simulate(seconds=0.2)
    run.write(tmp_path / "run.csv")
    recording = furuta.read_recording(tmp_path / "run.csv")
    assert np.array_equal(recording.measured, run.measurement[:, :4], equal_nan=True)
    assert not np.array_equal(recording.measured[:, :3], run.estimate[:, :3])
    assert np.array_equal(recording.command, run.command)
    counts = run.measurement[:, 0] / (2 * pi / 250)
    assert counts == pytest.approx(np.round(counts))
    assert np.all(np.isnan(run.measurement[:, 3]))


def test_sweep_is_a_table_of_measurements() -> None:
    """The last parameter changes fastest; what is impossible has a reason."""
    levels = np.array([0.1, -5.0])
    table = furuta.sweep({"plant.friction.alpha0": levels, "omega1": range(6, 8)}, seconds=1.0)
    assert {values.shape for values in table.values()} == {(4,)}
    assert table["omega1"].tolist() == [6, 7, 6, 7]
    assert table["error"][2] == "friction.alpha0 must be 0 to 100000 V, given -5"
    assert np.isnan(table["steps"][2:]).all()


def test_comparison_of_random_rigs_is_a_table() -> None:
    """Rigs by their number are those of a table, and each is a loop."""
    rigs = furuta.random_rigs(2, disturbances=["coupling"])
    loop = furuta.make_loop({name: values[1] for name, values in rigs.items()})
    assert loop.plant.coupling.backlash == rigs["plant.coupling.backlash"][1] > 0.0
    rigs = furuta.random_rigs(2)
    mine = {"none": {}, "stiff": {"compensation": "lugre", "sigma0": np.int64(1000)}}
    runs = furuta.compare(candidates=mine, rigs=rigs, seconds=5.0, keep_runs=True).runs
    texts = ["none", "stiff=compensation=lugre,sigma0=1000"]
    table = furuta.compare(candidates=texts, rigs=2, seconds=5.0, pushes=[0.0])
    for name, worst in zip(table["candidate"], table["residual_worst_rad"], strict=True):
        assert worst == runs["phi_peak_to_peak_rad"][runs["candidate"] == name].max()
    assert table["recommended"].sum() == 1
    assert table["pushes"].tolist() == [0, 0]


def test_loop_prints_what_differs() -> None:
    assert repr(furuta.Loop()) == "Loop()"
    loop = furuta.make_loop({"plant.friction.alpha0": 0.3, "omega1": 6.0})
    assert repr(loop) == "Loop(plant.friction.alpha0=0.3, controller.omega1=6)"
    assert len(repr(furuta.make_loop(rig="qube_servo_2"))) < 300


@pytest.mark.parametrize("name", ["linearize", "limit_cycle", "measure", "predict_cycles", "tune"])
def test_what_is_no_loop_is_a_parameter_error(name: str) -> None:
    for value in (furuta.Loop(controller=None), "a", furuta.FurutaPendulum, np.zeros(3)):
        with pytest.raises(furuta.ParameterError, match=r"loop(\.controller)? must be .*, given"):
            getattr(furuta, name)(value)


@pytest.mark.parametrize("value", [nan, inf, "a", None, [1.0], True, 10**5000], ids=shortened)
def test_what_is_no_number_is_a_parameter_error(value: Any) -> None:
    with pytest.raises(furuta.ParameterError) as error:
        furuta.simulate(seconds=value)
    assert "\n" not in str(error.value)
