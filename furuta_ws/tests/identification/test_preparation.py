"""Preparation and regression: units, signs, zeros, missing commands, ceilings, refusals.

With FURUTA_RIGS=200 in the environment 200 random rigs are tried, by default a few.
"""

import os

import numpy as np
import pytest
from random_rigs import DEGREE, EXAMPLE, Readings, example, record, sampled

from furuta.identification.identify import identify
from furuta.identification.options import Options
from furuta.identification.preparation.prepare import prepare, prepare_all
from furuta.identification.regression.equations import (
    CommandScale,
    arm_rows,
    command_scales,
    fitted_ceiling,
)
from furuta.identification.regression.first_estimate import first_estimate
from furuta.identification.regression.speeds import speed_lag, with_speeds
from furuta_model.parameters import ParameterError
from furuta_model.state import THETA
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import EXCERPT, EXCERPTS, excerpts_of, split_into_runs

RIGS = int(os.environ.get("FURUTA_RIGS", "8"))


@pytest.fixture(scope="module")
def usual() -> Recording:
    return example("sine", 2.0)


def test_recordings_of_one_call_share_units() -> None:
    small = example("steps", 0.3, Readings(DEGREE, DEGREE))
    small = small._replace(measured=small.measured / np.ptp(small.measured[:, THETA]))
    with pytest.raises(ParameterError, match="--angles"):
        prepare(small, Options())
    large = example("steps", 2.5, Readings(DEGREE, DEGREE))
    assert prepare_all([small, large], Options()).angles == "deg"
    assert prepare_all([example("sine", 0.5), example("steps", 2.5)], Options()).angles == "rad"


def test_an_odd_zero_asks_for_its_option() -> None:
    """A zero at 90° is not guessed; the option accepts the angle of the hanging pendulum."""
    odd = example("steps", 2.5).reoriented(0.5 * np.pi, 1.0, 1.0)
    with pytest.raises(ParameterError, match=r"hang at a measured angle of 90°; .*--zero"):
        prepare(odd, Options())
    ready = prepare(odd, Options(zero=0.5 * np.pi))
    assert np.cos(ready.measured[0, THETA]) == pytest.approx(-1.0, abs=0.01)
    assert "90° from hanging" in ready.findings[-1]


def test_a_direction_that_the_motion_does_not_show() -> None:
    """It is that of the other recordings, or asked."""
    rig, rng = EXAMPLE._replace(gamma=1e-5), np.random.default_rng(0)
    apart = record(rig, "steps", 2.5, 5.0, Readings(), rng, "apart")
    with pytest.raises(ParameterError, match="--direction"):
        prepare(apart, Options())
    both = prepare_all([apart, example("steps", 2.5)], Options())
    assert "that of the other" in both.recordings[0].findings[-1]
    assert prepare_all([apart], Options(direction=-1.0)).direction == -1.0


def test_a_speed_that_does_not_match_its_angle_is_ignored(usual: Recording) -> None:
    odd = usual._replace(measured=usual.measured * [1, 2.0, 1, 1])
    ready = prepare(odd, Options())
    assert np.all(np.isnan(ready.measured[:, 1]))
    assert any("arm's speed is not the slope of its angle" in finding for finding in ready.findings)


def test_times_since_1970_give_the_same_speeds(usual: Recording) -> None:
    """Squares of such times have no digits left for the intervals."""
    measured = usual.measured.copy()
    measured[:, THETA + 1] = np.nan
    early = usual._replace(measured=measured)
    late = early._replace(time=early.time + 1.7e9)
    speed, late_speed = (with_speeds(r, 0.0).measured[:, THETA + 1] for r in (early, late))
    np.testing.assert_allclose(late_speed, speed, atol=1e-3 * np.max(np.abs(speed)))


def test_commands_that_cannot_be_volts_are_refused(usual: Recording) -> None:
    odd = usual._replace(command=1000.0 * usual.command)
    with pytest.raises(ParameterError, match="--command-scale"):
        prepare(odd, Options())
    back = prepare(odd, Options(command_scale=1e-3))
    np.testing.assert_allclose(back.command, usual.command)


def test_incomplete_recordings_are_refused(usual: Recording) -> None:
    without_command = usual._replace(command=np.zeros(0), command_time=np.zeros(0))
    with pytest.raises(ParameterError, match="no command in it"):
        prepare(without_command, Options())
    without_angle = usual._replace(measured=np.full(usual.measured.shape, np.nan))
    with pytest.raises(ParameterError, match="no angle of the arm"):
        prepare(without_angle, Options())


def test_dropouts_are_interpolated_and_reported(usual: Recording) -> None:
    keep = np.abs(usual.time - 2.0) > 0.05
    measured = usual.measured.copy()
    measured[500:520, 1] = np.nan
    measured[700, 0] = np.nan
    gappy = usual._replace(time=usual.time[keep], measured=measured[keep])
    ready = prepare(gappy, Options())
    assert np.all(np.isfinite(ready.measured))
    assert any("dropout of 0.1" in finding for finding in ready.findings)
    assert any(f"1 of {np.sum(keep)} samples dropped" in finding for finding in ready.findings)


def test_a_log_that_starts_in_motion(usual: Recording) -> None:
    ready = prepare(usual.between(1.0, np.inf), Options())
    assert ready.commanded_at(ready.time[:1]) != 0.0
    assert any("in motion at the start" in finding for finding in ready.findings)


def test_several_runs_in_one_log_are_split(usual: Recording) -> None:
    first, short = usual.between(0.0, 3.0), usual.between(0.0, 0.5)
    both = Recording(
        "both",
        np.concatenate((first.time, usual.time + 100.0, short.time + 200.0)),
        np.concatenate((first.measured, usual.measured, short.measured)),
        np.concatenate((first.command_time, usual.command_time + 100.0)),
        np.concatenate((first.command, usual.command)),
    )
    runs = split_into_runs(both)
    assert [run.name for run in runs] == ["both (1)", "both (2)"]
    np.testing.assert_array_equal(runs[0].command, first.command)
    np.testing.assert_array_equal(runs[1].command_time, usual.command_time + 100.0)
    assert "2 of 3 runs used" in runs[0].findings[0]
    assert split_into_runs(first) == [first]
    with pytest.raises(ParameterError, match="or give each run as a recording of its own"):
        cleaned(both._replace(time=both.time % 100.0))


def test_long_recordings_are_fitted_in_excerpts() -> None:
    time = np.arange(100_000) * 5e-4
    measured = np.column_stack([np.sin(3.0 * time)] * 4)
    measured[time < 10.0] = 0.0
    log = Recording("long", time, measured, time[::10], np.arange(10_000.0))
    assert excerpts_of(log, 100_000) == [log]
    excerpts = excerpts_of(log, 30_000)
    assert len(excerpts) == EXCERPTS
    for part in excerpts:
        assert len(part.time) == EXCERPT
        assert part.interval == pytest.approx(1e-3)
        assert part.time[0] >= 9.0
        np.testing.assert_array_equal(part.commanded_at(part.time), log.commanded_at(part.time))
    assert "excerpts of 2.0 s of 50.0 s" in excerpts[0].findings[0]


def test_the_ceiling_shows_in_larger_commands() -> None:
    for amplitude, expected in ((4.5, 3.0), (2.5, np.inf)):
        ready = prepare(example("chirp", amplitude), Options())
        ceiling, _ = fitted_ceiling(arm_rows([ready], speed_lag(ready), 0.003))
        assert ceiling == pytest.approx(expected, rel=0.05)


def _numbered(recordings: list[Recording]) -> list[Recording]:
    """Prepared recordings of several runs."""
    numbered = [r._replace(number=number) for number, r in enumerate(recordings)]
    return prepare_all(numbered, Options()).recordings


def test_steps_of_two_levels_show_the_ceiling() -> None:
    """The larger one moves the arm less than in proportion."""
    rig = EXAMPLE._replace(ceiling=3.5)
    recordings = [
        record(rig, "step", u, 4.0, Readings(), np.random.default_rng(k))
        for k, u in enumerate((2.5, 4.5))
    ]
    found, _ = fitted_ceiling(arm_rows(_numbered(recordings), EXAMPLE.lag, EXAMPLE.delay))
    assert found == pytest.approx(3.5, rel=0.05)


@pytest.mark.parametrize("factor", [1.0, 8.0, -1.0])
def test_a_command_in_another_unit_is_noticed(factor: float) -> None:
    """Its recording and the factor are named; a shared unit is not doubted."""
    other = example("sine", 2.0)
    other = other._replace(command=other.command * factor)
    ready = _numbered([example("steps", 2.5), other, example("chirp", 2.5)])
    scales = command_scales(arm_rows(ready, EXAMPLE.lag, EXAMPLE.delay))
    best = min(scales, key=lambda scale: scale.misfit)
    assert best.differs == (factor != 1.0)
    if best.differs:
        assert best.name == "sine"
        assert best.factor == pytest.approx(1.0 / factor, rel=0.05)
        with pytest.raises(
            ParameterError, match=r"sine: a command of 1 acts like .*--command-scale"
        ):
            identify([example("steps", 2.5), other], Options())


def test_a_scale_that_is_not_known_differs_from_nothing() -> None:
    assert not CommandScale("a", 0.01, 0.02, 0.1).differs
    assert not CommandScale("a", 1.2, 0.001, 0.1).differs
    assert CommandScale("a", 1.5, 0.1, 0.1).differs


def test_angles_in_several_units_are_refused() -> None:
    degrees = example("steps", 2.5, Readings(DEGREE, DEGREE))._replace(number=1, name="odd")
    with pytest.raises(ParameterError, match="odd: its motion shows angles in deg"):
        prepare_all([example("sine", 2.0), degrees], Options())


def wrong_decisions(readings: Readings, recording: Recording) -> list[str]:
    """What is decided wrongly about a recording; raises what is asked."""
    prepared = prepare_all([recording], Options())
    (ready,) = prepared.recordings
    lag = speed_lag(ready)
    estimate = first_estimate([ready], lag)
    decisions = {
        "unit": (prepared.angles == "deg") == (readings.unit != 1.0),
        "zero": bool(np.cos(ready.measured[0, 2]) < -0.8),
        "direction": prepared.direction == readings.pendulum,
        "motor": estimate.negated == (readings.motor < 0.0),
    }
    return [name for name, right in decisions.items() if not right]


def test_nothing_is_decided_wrongly() -> None:
    """Units, zeros, directions and the motor's sign; at most one in twenty, or one, is asked."""
    asked = []
    for seed in range(RIGS):
        _, readings, recording = sampled(seed)
        try:
            assert wrong_decisions(readings, recording) == [], seed
        except ParameterError as error:
            asked.append(str(error))
    print(f"{RIGS} rigs: asked {len(asked)}", *asked, sep="\n")
    assert len(asked) <= max(1, RIGS // 20)
