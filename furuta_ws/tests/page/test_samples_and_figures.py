"""Samples, figures, sliders, pacing and jobs of the page, without a browser and without ROS."""

import threading
from math import pi

import numpy as np
import pytest

from furuta_bringup.page.exact_cycle import analysed_loop, exact_cycle
from furuta_bringup.page.figures import Elapsed, Figures, figures, measuring, swing
from furuta_bringup.page.jobs import Jobs
from furuta_bringup.page.parameter_panel import Described, slider_range
from furuta_bringup.page.samples import COLUMNS, PHI, THETA, TIME, Samples
from furuta_model.parameters import ParameterError


def motion(seconds: float, amplitude: float, period: float) -> np.ndarray:
    """Samples (n, 8) of a sine of the arm, a hundred per second."""
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


def test_figures_of_a_sine() -> None:
    """Of the last five seconds: a larger motion before does not count."""
    later = motion(6.0, 0.25, 2.0)
    later[:, TIME] += 10.0
    rows = np.vstack([motion(10.0, 2.0, 1.0), later])
    expected = (0.5, 0.05, 2.0, 0.5 * 250 / (2 * pi))
    assert figures(rows, 250) == pytest.approx(expected, rel=1e-3)


def test_figures_are_those_since_the_last_change() -> None:
    """Until all of the window is after it, the page says how long that takes, and no number."""
    elapsed, times = Elapsed(), np.arange(10.0, 20.0, 0.01)
    assert [elapsed.passed(times + later) for later in (0.0, 2.5)] == [0.0, 2.5]
    wait = measuring(2.5, 5.0)
    assert wait == "measuring: 3 s"
    assert Figures(0.5, 0.1, 2.0, 20.0).rows(wait)[0] == ("arm", wait)
    assert "0.5" not in str(Figures(0.5, 0.1, 2.0, 20.0).rows(wait))
    elapsed.restart()
    assert elapsed.passed(times + 3.0) == 0.0
    times[-100:] += 0.2  # a reset, of which the page may not know
    assert elapsed.passed(times + 6.0) == pytest.approx(0.99)
    assert elapsed.passed(times - 9.0) == 0.0  # another graph
    assert measuring(5.0, 5.0) == ""


def test_people_read_degrees() -> None:
    """With a second digit where the first one alone would say little; unknown is not a number."""
    assert [swing(angle) for angle in (0.511, 0.0511, np.nan)] == ["29.3°", "2.93°", "–"]
    assert Figures(0.511, np.nan, np.nan, 20.3).rows() == [
        ("arm", "29.3° peak to peak"),
        ("pendulum", "–"),
        ("period", "–"),
        ("arm in encoder counts", "20.3"),
    ]


def test_slider_reaches_useful_values() -> None:
    """A few times the value, not the whole range; whole numbers stay whole."""
    assert slider_range(0.21, 0.0, 100.0)[:2] == pytest.approx((0.0, 0.7))
    low, high, step = slider_range(4, 1, 8)
    assert (low, high) == (1, 8)
    assert isinstance(step, int)


def test_parameter_is_described_by_its_services_alone() -> None:
    """Unit from the meaning, choices from the constraints, as our nodes write them."""
    law = Described("friction.law", "lugre", "friction law", "one of lugre, coulomb")
    assert law.choices == ("lugre", "coulomb")
    own = law._replace(value="a:b", constraints="one of lugre, coulomb, or an own one as module:f")
    assert own.choices == ("lugre", "coulomb", "a:b")
    gain = Described("gain", [0.0], "explicit L of u = -Lx [V/x]", "any")
    assert gain.label == "gain [V\N{DIVISION SLASH}x]"
    assert gain.parsed("[1, 2.5]") == [1.0, 2.5]
    with pytest.raises(ParameterError, match="gain must be a list of numbers, given 'high'"):
        gain.parsed("high")


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
    cycle = exact_cycle(loop)
    assert cycle is not None
    assert np.ptp(cycle[:, 1]) == pytest.approx(0.510, abs=2e-3)
    assert analysed_loop({"controller": {}, "friction_observer": {}}) == loop
    assert analysed_loop({"estimator": {}}) is None
    assert analysed_loop(values | {"plant": {"tilt.x": 0.1}}) is None  # the plant is another one
