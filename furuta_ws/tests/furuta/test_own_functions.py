"""Functions of one's own as parts of a loop: equal to the built-in parts, and to Python."""

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numba.core import event
from own_parts import LUGRE, Count, array_counting, counting, differences, feedback, stribeck
from random_loops import random_loop

import furuta
from furuta.lanes.lanes import prepare, run_block
from furuta.outcomes import SETTLED, outcome
from furuta.settings.settings import load_settings
from furuta_model.accepted_parts import accept_parts, part_name
from furuta_sim.simulation.closed_loop import Simulation


def misspelt(v: float, p: Any) -> float:
    """Uses a parameter that there is not."""
    level = p.alpha0
    return level + p.alpha7 * v


def silent(v: float, p: Any) -> None:
    """Returns nothing."""


def constant(level: float) -> Any:
    """A law of constant level [V]."""
    return lambda v, p: level


@pytest.mark.parametrize(("law", "own"), [("stribeck", stribeck), ("lugre", LUGRE)])
def test_law_with_the_arithmetic_of_the_house_has_its_bits(law: str, own: Any) -> None:
    """In the simulation, and its limit cycle is the same."""
    plain = furuta.make_loop({"plant.friction.law": law})
    named = furuta.make_loop({"friction.law": own})
    np.testing.assert_array_equal(
        furuta.simulate(named, 5.0).state, furuta.simulate(plain, 5.0).state
    )
    ours, theirs = furuta.limit_cycle(named), furuta.limit_cycle(plain)
    assert ours.phi_peak_to_peak_rad == pytest.approx(theirs.phi_peak_to_peak_rad, rel=1e-9)
    assert ours.period_s == pytest.approx(theirs.period_s, rel=1e-9)


@pytest.mark.parametrize("function", [counting, array_counting])
def test_compensator_is_the_function_in_python(function: Any) -> None:
    """Sample by sample, with what it remembers."""
    run = furuta.simulate(seconds=2.0, compensation=function)
    memory = Count() if function is counting else np.zeros(2)
    p = furuta.Loop().observer
    expected = [function(memory, x, p) for x in run.estimate]
    np.testing.assert_allclose(run.friction_estimate, expected, rtol=1e-12, atol=1e-15)


def test_controller_is_the_feedback_of_the_house() -> None:
    """While nothing is at a limit."""
    own = furuta.simulate(seconds=5.0, controller=feedback)
    house = furuta.simulate(seconds=5.0)
    np.testing.assert_allclose(own.command, house.command, rtol=1e-9, atol=1e-9)


def test_estimator_is_the_function_in_python() -> None:
    """From the first measurement on."""
    run = furuta.simulate(seconds=2.0, estimator=differences)
    x = run.estimate[0].copy()
    for k, measurement in enumerate(run.measurement[1:], start=1):
        differences(None, x, measurement, furuta.Loop().estimator)
        np.testing.assert_allclose(run.estimate[k, :4], x[:4], rtol=1e-12, atol=1e-15)
        assert run.estimate[k, 4] == measurement[4]


@pytest.mark.parametrize("earlier", [(array_counting,), (counting, "none")])
def test_memory_starts_at_zero(earlier: tuple[Any, ...]) -> None:
    """A function does not find what another one, or it itself before a switch, has left."""
    changing = Simulation(furuta.make_loop({"compensation": earlier[0]}))
    for each in earlier:
        changing.loop = furuta.make_loop({"compensation": each})
        changing.run(1.0)
    changing.loop = furuta.make_loop({"compensation": counting})
    run = changing.run(1.0)
    memory = Count()
    expected = [counting(memory, x, changing.loop.observer) for x in run.estimate]
    np.testing.assert_allclose(run.friction_estimate, expected, rtol=1e-12, atol=1e-15)


def test_functions_of_one_name_are_different() -> None:
    """Such as those that a function makes."""
    low, high = constant(0.1), constant(0.3)
    names = {part_name(low), part_name(high)}
    assert len(names) == 2
    assert part_name(low) in names
    sizes = [furuta.measure(seconds=60.0, friction=law).phi_peak_to_peak_rad for law in (low, high)]
    assert sizes[1] > 1.5 * sizes[0]


def constant_compensator(estimate: float) -> Any:
    """A compensator of constant estimate [V]."""
    return lambda memory, x, p: estimate


def test_a_further_function_compiles_nothing_but_itself() -> None:
    """Numba never frees machine code, so a loop over functions must not compile more."""
    furuta.simulate(seconds=0.01, compensation=constant_compensator(0.0))
    estimates = np.linspace(0.01, 0.05, 5)
    with event.install_recorder("numba:compile") as recorder:
        runs = [
            furuta.simulate(seconds=0.01, compensation=constant_compensator(estimate))
            for estimate in estimates
        ]
    compiled = [each.data["dispatcher"].__name__ for _, each in recorder.buffer if each.is_start]
    assert compiled == ["<lambda>"] * len(estimates)
    assert [set(run.friction_estimate) for run in runs] == [{estimate} for estimate in estimates]


@pytest.mark.parametrize(
    ("part", "message"),
    [
        (misspelt, r"misspelt cannot be compiled \(.*test_own_functions.py, line \d+\): .*alpha7"),
        (silent, r"silent .* must return a number, and returns nothing"),
        (lambda v: v, r"line \d+\): it takes 1 arguments, and is called with 2"),
        ("bumpy", "one of coulomb, .* or one of own_parts, given 'bumpy'"),
    ],
)
def test_bad_part_is_one_line(part: Any, message: str) -> None:
    """With the file and the line of the error."""
    with pytest.raises(furuta.ParameterError, match=message) as error:
        furuta.make_loop({"friction.law": part})
    assert "\n" not in str(error.value)


NAMING_CODE = ("friction.law", "compensation", "mode", "estimator.method")


@pytest.mark.parametrize("parameter", NAMING_CODE)
def test_a_name_that_is_not_accepted_imports_nothing(evil: Path, parameter: str) -> None:
    """Wherever it comes from: the check of the parameters refuses it."""
    modules = set(sys.modules)
    for name in ("evil:f", "evil.py:f", "os:system", ":"):
        with pytest.raises(furuta.ParameterError, match="not accepted; name it when the process"):
            load_settings([], [f"{parameter}={json.dumps(name)}"])
    assert not {each.partition(".")[0] for each in set(sys.modules) - modules} - {"furuta"}
    assert not hasattr(sys, "loaded_evil")


def test_working_directory_is_no_import_path(evil: Path) -> None:
    """Whoever starts the process names its file, or puts a module on Python's path."""
    with pytest.raises(furuta.ParameterError, match=r"No module named 'evil'; .* file.py:function"):
        accept_parts(["evil:f"])
    assert not hasattr(sys, "loaded_evil")
    accept_parts(["evil.py:f"])
    assert hasattr(sys, "loaded_evil")
    assert (furuta.simulate(furuta.make_loop({"mode": "evil.py:f"}), 0.1).command == 0.25).all()


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("venv.__main__:x", "cannot load the part 'venv.__main__:x': SystemExit"),
        ("no_such.py:f", "cannot load the part 'no_such.py:f': FileNotFoundError"),
        ("os:system", "os:system must be a Python function, given builtin_function"),
    ],
)
def test_a_part_that_cannot_be_used_is_one_line(evil: Path, name: str, reason: str) -> None:
    """When the process starts, or when a parameter chooses it."""
    with pytest.raises(furuta.ParameterError, match=reason) as error:
        accept_parts([name])
        load_settings([], [f"mode={name}"])
    assert "\n" not in str(error.value)


def test_an_exception_is_reported_with_its_line(caplog: pytest.LogCaptureFixture) -> None:
    """The compensation is 0 V then, and the run goes on."""
    run = furuta.simulate(seconds=0.5, compensation=failing)
    late = run.estimate[:, 0] > LIMIT
    assert late.any()
    np.testing.assert_array_equal(run.friction_estimate, np.where(late, 0.0, 0.5))
    line = failing.__code__.co_firstlineno + 3
    assert (
        f"failing failed and gave 0 ({__file__}, line {line}): ValueError: too far" in caplog.text
    )
    assert len(caplog.records) == 1


# Where `failing` fails [rad].
LIMIT = 0.01


def failing(memory: Any, x: Any, p: Any) -> float:
    """Fails where the arm is too far."""
    if x[0] > LIMIT:
        raise ValueError("too far")
    return 0.5


def test_an_estimator_that_fails_starts_anew(caplog: pytest.LogCaptureFixture) -> None:
    """Its estimate is unknown for one sample, which the controller answers with 0 V."""
    run = furuta.simulate(seconds=0.5, estimator=failing_at_100)
    failed = np.flatnonzero(np.isnan(run.estimate[:, 2]))
    np.testing.assert_array_equal(failed, [100, 201, 302, 403])  # its memory starts at zero again
    assert not run.command[failed].any()
    assert "failing_at_100 failed and gave 0" in caplog.text


def failing_at_100(memory: Any, x: Any, measurement: Any, p: Any) -> None:
    """Passes the measurement on, and fails at its sample of number 100."""
    memory[0] += 1
    x[2] = measurement[2]
    if memory[0] == 100:
        raise ValueError("100")
    x[0], x[1], x[3], x[4] = measurement[0], measurement[1], 0.0, 0.0


@dataclass
class Started:
    """A memory that does not start at zero."""

    level: float = 1.0


def test_memory_of_the_wrong_size_or_start_is_refused() -> None:
    """It would be silently wrong otherwise."""

    def started(memory: Started, x: Any, p: Any) -> float:
        return 0.0

    with pytest.raises(furuta.ParameterError, match="Started must start at zero"):
        furuta.simulate(seconds=1.0, compensation=started)


@pytest.mark.long
def test_own_law_in_lanes_has_the_bits_of_single_runs() -> None:
    """Loops with different functions share a block."""
    r = np.random.default_rng(1)
    first = random_loop(r, "lugre", "none", "kalman", False)
    names = [part_name(LUGRE), part_name(LUGRE._replace(level=constant(0.2)))]
    frictions = [first.plant.friction._replace(law=names[k % 2]) for k in range(8)]
    plants = [first.plant._replace(friction=each, seed=k) for k, each in enumerate(frictions)]
    loops = [first._replace(plant=plant) for plant in plants]
    ready = [prepare(each, 2.0) for each in loops]
    assert len({each.group for each in ready if each}) == 1
    found = run_block([each for each in ready if each], SETTLED)
    for each, single in zip(found, (outcome(one, 2.0) for one in loops), strict=True):
        np.testing.assert_array_equal(each, single)
