"""Theorems on hunting: small instances of their tables, and independent values."""

import numpy as np
import pytest
from hunting_reference import lugre_fold, stribeck_fold

from furuta.axis.axis import Axis, Pid, servo_cycle
from furuta.axis.compensated import compensated_cycle
from furuta.axis.folds import EXAMPLE, GAINS, fold
from furuta.axis.reset_integral import settling
from furuta.axis.theorems import THEOREMS, theorem
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError

MANY = pytest.param(10_000, marks=[pytest.mark.long, pytest.mark.timeout(3600)])


@pytest.mark.parametrize("name", ["coulomb", "stiction"])
@pytest.mark.parametrize("loops", [20, MANY])
def test_coulomb_friction_alone_never_hunts_and_static_friction_always_does(
    name: str, loops: int
) -> None:
    report = theorem(name, loops, seed=20261124)
    assert report["holds"], report["rows"]
    assert sum(row["loops"] for row in report["rows"]) == loops


@pytest.mark.timeout(60)
def test_a_joint_at_the_limit_of_its_friction_is_at_rest() -> None:
    """On the way to a cycle the engine meets slides of 1e-22 s, on which time does not advance."""
    axis = Axis(27.860797278697245, Friction(alpha0=0.30068472226519616, alpha1=0.0, viscous=0.0))
    gains = Pid(kp=28548.521345677415, ki=1460698.0487461183, kd=2229.6578793434733)
    assert servo_cycle(axis._replace(law="coulomb"), gains).kind == "rest"


def test_no_state_feedback_brings_the_pendulum_to_rest() -> None:
    assert theorem("pendulum", 4)["holds"]


@pytest.mark.long
def test_fold_under_stribeck_friction_is_that_of_independent_shooting() -> None:
    axis = EXAMPLE._replace(law="stribeck")
    found = fold(lambda kd: (axis, GAINS._replace(kd=kd)), 0.4, 2.5)
    assert found is not None
    assert found.value == pytest.approx(stribeck_fold(axis, GAINS, (0.06, 0.1)), rel=1e-6)


@pytest.mark.long
def test_fold_under_lugre_friction_is_that_of_independent_shooting() -> None:
    axis = EXAMPLE._replace(law="lugre")
    found = fold(lambda kd: (axis, GAINS._replace(kd=kd)), 0.4, 2.5)
    assert found is not None
    assert found.value == pytest.approx(lugre_fold(axis, GAINS, (0.08, 0.1)), rel=1e-5)


def test_there_is_no_fold_where_nothing_hunts() -> None:
    smooth = EXAMPLE._replace(friction=EXAMPLE.friction._replace(stribeck_velocity=10.0))
    assert fold(lambda kd: (smooth, GAINS._replace(kd=kd)), 1.0, 2.0) is None


def test_reset_integral_settles_where_pid_hunts() -> None:
    """PID hunts as the engine says, to the accuracy of the sampling."""
    report = theorem("reset")
    assert report["holds"], report["rows"]
    for row in report["rows"]:
        expected = pytest.approx(row["exact_peak_to_peak_rad"], rel=1e-3)
        assert row["pid_peak_to_peak_rad"] == expected


def test_reset_does_not_matter_before_the_error_changes_sign() -> None:
    axis = EXAMPLE._replace(law="coulomb")
    slow = Pid(4.0, 0.0, 40.0)
    assert settling(axis, slow, True, 5.0) == settling(axis, slow, False, 5.0)


@pytest.mark.parametrize("compensation", [1.05, 1.3])
def test_cycle_of_too_much_compensation_is_that_of_a_relay(compensation: float) -> None:
    """Between reversals the axis swings about ±(c − 1) α₀/k_p; half a period decays by ρ."""
    axis, pid = Axis(0.02, Friction(alpha0=0.3, alpha1=0.0), "coulomb"), Pid(2.0, 0.0, 0.1)
    zeta = pid.kd / (2.0 * np.sqrt(pid.kp * axis.inertia))
    rho = np.exp(-np.pi * zeta / np.sqrt(1.0 - zeta**2))
    centre = (compensation - 1.0) * axis.friction.alpha0 / pid.kp
    cycle = compensated_cycle(axis, pid, compensation)
    assert cycle.kind == "limit_cycle"
    assert cycle.stable
    assert cycle.peak_to_peak == pytest.approx(2 * centre * (1 + rho) / (1 - rho), rel=1e-10)
    assert cycle.floquet_multipliers[0].real == pytest.approx(rho**2, rel=1e-4)


def test_only_too_much_compensation_cycles() -> None:
    assert theorem("compensation")["holds"]


def test_bad_input_is_rejected() -> None:
    with pytest.raises(ParameterError, match=f"no theorem tea, only {', '.join(THEOREMS)}"):
        theorem("tea")
    with pytest.raises(ParameterError, match="above 0, given 0"):
        theorem("coulomb", 0)
    with pytest.raises(ParameterError, match="under PD and coulomb or stiction"):
        compensated_cycle(EXAMPLE, Pid(1.0, 1.0, 1.0), 1.1)
