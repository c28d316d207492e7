"""Samples, sliders, pacing and jobs of the page, without a browser and without ROS."""

import threading
from math import pi

import numpy as np
import pytest

from furuta_bringup.page.described import Described, slider_range
from furuta_bringup.page.exact_cycle import analysed_loop, described_cycle
from furuta_bringup.page.jobs import Jobs
from furuta_bringup.page.pacer import FOREVER, Pacer
from furuta_bringup.page.samples import COLUMNS, PHI, THETA, TIME, Samples


def motion(seconds: float, amplitude: float, period: float) -> np.ndarray:
    """Samples (n, 7) of a sine of the arm, a hundred per second."""
    rows = np.zeros((round(100 * seconds), COLUMNS))
    rows[:, TIME] = np.arange(len(rows)) / 100
    rows[:, PHI] = amplitude * np.sin(2 * pi / period * rows[:, TIME])
    rows[:, THETA] = 0.1 * rows[:, PHI]
    return rows


def test_samples_keep_the_newest() -> None:
    """In order, and only those of the seconds that are asked for; time that goes back starts anew.

    A curve from an earlier graph to the present one would mislead.
    """
    samples = Samples(300)
    assert len(samples.last(10.0)) == 0
    for row in motion(7.0, 1.0, 2.0):
        samples.add(row)
    assert samples.last(2.0)[:, TIME] == pytest.approx(np.arange(500, 700) / 100)
    assert len(samples.last(10.0)) == 300
    samples.add(np.zeros(COLUMNS))
    assert len(samples.last(10.0)) == 1


def test_slider_reaches_useful_values() -> None:
    """A few times the value, not the whole range."""
    assert slider_range(0.21, 0.0, 100.0)[:2] == pytest.approx((0.0, 0.7))
    assert slider_range(1.0, 0.0, 2.0)[:2] == (0.0, 2.0)


def test_parameter_is_described_by_its_services_alone() -> None:
    """Unit from the meaning, choices from the constraints, as our nodes write them."""
    law = Described("friction.law", "lugre", "friction law", "one of lugre, coulomb")
    assert law.choices == ("lugre", "coulomb")
    own = law._replace(value="a:b", constraints="one of lugre, coulomb, or an own one as module:f")
    assert own.choices == ("lugre", "coulomb", "a:b")
    gain = Described("gain", [0.0], "explicit L of u = -Lx [V/x]", "any")
    assert gain.unit == "V/x"


def test_lock_step_runs_as_fast_as_it_is_told() -> None:
    """Not ahead of a plant that cannot keep up; a pause holds, and a step moves it on by 10 ms."""
    pacer = Pacer()
    assert pacer.run_until(0.0, 0.0) == FOREVER
    pacer.pace(0.5, 0.0)
    assert pacer.run_until(1.0, 0.0) == pytest.approx(0.5)
    assert pacer.run_until(1.5, 0.2) == pytest.approx(0.75)
    assert pacer.run_until(9.0, 0.2) == pytest.approx(0.7 + 3.75)
    pacer.pace(0.0, 1.0)
    assert pacer.run_until(10.0, 1.0) == 1.0
    pacer.step(1.0)
    assert 1.01 < pacer.run_until(11.0, 1.0) < 1.02
    assert pacer.speed == 0.0


def test_only_the_newest_of_waiting_jobs_runs() -> None:
    """A slider that is dragged sends one value at a time, in the end the last one."""
    jobs, begun, go_on = Jobs(), threading.Event(), threading.Event()
    done: list[int] = []

    def first() -> None:
        begun.set()
        go_on.wait()

    jobs.submit("block", first)
    assert begun.wait(60.0)
    for number in range(100):
        jobs.submit("slider", lambda number=number: done.append(number))
    assert jobs.pending("slider")
    ended = threading.Event()
    jobs.submit("end", ended.set)
    go_on.set()
    assert ended.wait(60.0)
    assert done == [99]
    jobs.close(60.0)


def test_exact_cycle_is_that_of_the_parameters() -> None:
    """With the paper's defaults 0.510 rad, as `furuta limit-cycle` prints.

    Without a plant, as on a rig, the friction is that of the observer; without both there is none.
    """
    values: dict[str, dict[str, float]] = {"plant": {}, "controller": {}}
    loop = analysed_loop(values)
    assert loop is not None
    cycle = described_cycle(loop)
    assert cycle is not None
    assert cycle["exact"] == pytest.approx(0.510, abs=2e-3)
    assert np.ptp(cycle["orbit"], axis=0)[0] == pytest.approx(cycle["exact"], rel=0.01)
    assert analysed_loop({"controller": {}, "friction_observer": {}}) == loop
    assert analysed_loop({"estimator": {}}) is None
    assert analysed_loop(values | {"plant": {"tilt.x": 0.1}}) is None  # the plant is another one
