"""A servo axis: from a recording to the prediction of its hunting and to a compensation."""

from pathlib import Path

import numpy as np
import pytest

import furuta
from furuta.axis.axis import Controller
from furuta.axis.identification import parse_friction
from furuta.limit_cycles.joint import JointCycle

FRICTION = furuta.Friction(alpha0=0.1, alpha1=0.1, stribeck_velocity=0.1, viscous=0.005)
AXIS = furuta.Axis(0.01, FRICTION)
PID = furuta.Pid(1.0, 2.0, 0.08)


def settled(axis: furuta.Axis, controller: Controller, cycle: JointCycle, **options: str) -> float:
    """Peak to peak [rad] of the simulated error over the last 10 of 20 periods."""
    run = furuta.simulate_axis(axis, controller, seconds=20.0 * cycle.period_s, **options)
    return float(np.ptp(run.error[len(run.error) // 2 :]))


def test_from_a_recording_to_a_compensation(tmp_path: Path) -> None:
    """The hunting of an identified axis is predicted within 5 %, then reduced to a tenth."""
    time = np.arange(0.0, 10.0, 1e-3)
    moves = 1.5 * np.sin(1.3 * time) + 0.6 * np.sin(3.7 * time) * np.sin(0.4 * time)
    recorded = furuta.simulate_axis(AXIS, PID, reference=moves, counts=4096)
    furuta.write_series(tmp_path / "axis.csv", recorded.columns)

    fit = furuta.identify_axis(furuta.read_axis(tmp_path / "axis.csv"))
    axis = furuta.identified_axis(fit)
    cycle = furuta.servo_cycle(axis, PID)
    recommended = furuta.compare_on_axis(axis, PID, cycle=cycle).recommended

    assert axis.inertia == pytest.approx(AXIS.inertia, rel=0.02)
    assert axis.friction.alpha0 == pytest.approx(FRICTION.alpha0, rel=0.02)
    assert axis.friction.alpha1 == pytest.approx(FRICTION.alpha1, rel=0.05)
    assert fit.resolution == pytest.approx(2.0 * np.pi / 4096, rel=1e-6)
    hunting = settled(AXIS, PID, cycle)
    assert cycle.peak_to_peak == pytest.approx(hunting, rel=0.05)
    assert settled(AXIS, PID, cycle, compensation=recommended.compensation) < 0.1 * hunting


@pytest.mark.parametrize("size", [1.0, 1e4])
def test_sampled_hunting_is_the_exact_cycle(size: float) -> None:
    """Encoder, observer and sampling change it by less than 5 %, whatever the unit of torque."""
    levels = {"alpha0": 0.1 * size, "alpha1": 0.1 * size, "viscous": 0.005 * size}
    axis = furuta.Axis(0.01 * size, FRICTION._replace(**levels))
    pid = furuta.Pid(size, 2.0 * size, 0.08 * size)
    cascade = furuta.Cascade(5.0, 0.1 * size, 0.5 * size)
    for controller in (pid, cascade):
        cycle = furuta.servo_cycle(axis, controller)
        assert cycle.kind == "limit_cycle"
        assert settled(axis, controller, cycle) == pytest.approx(cycle.peak_to_peak, rel=0.05)


def test_recommendation_without_integral_action() -> None:
    """An axis that rests beside its reference gets the compensation that brings it nearer."""
    pd = PID._replace(ki=0.0)
    compared = furuta.compare_on_axis(AXIS, pd)
    errors = {residual.compensation: residual.error_rad for residual in compared.residuals}
    assert errors["none"] > 0.01
    assert compared.recommended.error_rad < 0.2 * errors["none"]


def test_slow_motion_sticks_and_slips() -> None:
    """At a low speed of the reference the error oscillates; far above the Stribeck velocity not."""
    slow, fast = (furuta.servo_cycle(AXIS, PID, speed) for speed in (0.02, 5.0))
    assert (slow.kind, fast.kind) == ("limit_cycle", "steady")
    run = furuta.simulate_axis(AXIS, PID, seconds=20.0 * slow.period_s, reference=0.02)
    error = run.error[len(run.error) // 2 :]
    assert np.ptp(error) == pytest.approx(slow.peak_to_peak, rel=0.1)


def test_bad_input_is_refused() -> None:
    for wrong in ("alpha0", "alpha0=x", "alpha0=-1", "beta=1", "alpha1=1", "alpha0=1,alpha1=1"):
        with pytest.raises(furuta.ParameterError):
            parse_friction(wrong, "stribeck")
    for options in ({"compensation": "magic"}, {"counts": -1}, {"reference": np.full(9, np.nan)}):
        with pytest.raises(furuta.ParameterError):
            furuta.simulate_axis(AXIS, PID, **options)  # type: ignore[arg-type]
    with pytest.raises(furuta.ParameterError, match="unbounded"):
        furuta.compare_on_axis(AXIS, furuta.Pid(1.0, 100.0, 0.01))
