"""Proofs of hunting in interval arithmetic."""

import numpy as np
import pytest

pytest.importorskip("flint")

from random_loops import random_axis

from furuta.axis.axis import Axis, Cascade, Controller, Pid, servo_cycle
from furuta.axis.proof import certificate, check, prove_cycle
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError

AXIS = Axis(0.01, Friction(alpha0=0.1, alpha1=0.05, viscous=0.01, asymmetry=0.2), "stiction")
PID = Pid(2.0, 6.0, 0.12)


def assert_proved(axis: Axis, controller: Controller) -> None:
    """The engine's cycle is the proved one; the bounds are much closer than its errors."""
    proof, cycle = prove_cycle(axis, controller), servo_cycle(axis, controller)
    assert proof.stable
    for (low, high), number, error in (
        (proof.peak_to_peak_rad, cycle.peak_to_peak, 1e-9),
        (proof.period_s, cycle.period_s, 1e-9),
        (proof.multiplier, cycle.floquet_multipliers[0].real, 1e-6),  # by finite differences
    ):
        assert 0.0 < high - low < 1e-12 * high
        assert number == pytest.approx(low, rel=error)


def test_random_axes_hunt() -> None:
    random = np.random.default_rng(0)
    for _ in range(20):
        assert_proved(*random_axis(random, "stiction"))


@pytest.mark.parametrize("controller", [PID, Cascade(5.0, 0.3, 1.0)])
def test_an_asymmetric_cycle(controller: Controller) -> None:
    assert_proved(AXIS, controller)


@pytest.mark.parametrize("field", ["error_up", "time_down"])
def test_a_wrong_certificate_is_refused(field: str) -> None:
    """A box beside the cycle, by a millionth of a millionth."""
    right = certificate(AXIS, PID)
    value, _, radius = getattr(right, field).partition(" ")
    moved = f"[{float(value[1:]) * (1.0 + 1e-12)!r} {radius}"
    with pytest.raises(ParameterError, match="not proved: Krawczyk"):
        check(AXIS, PID, right._replace(**{field: moved}))


@pytest.mark.parametrize(
    ("axis", "controller", "reason"),
    [
        (AXIS._replace(law="coulomb"), PID, "law stiction"),
        (AXIS, Pid(2.0, 0.0, 0.12), "an integral"),
        (AXIS, Pid(2.0, 6.0, 0.12, 0.01), "no filter"),
        (AXIS, Pid(2.0, 60.0, 0.12), "no periodic cycle"),
    ],
)
def test_what_is_not_proved(axis: Axis, controller: Controller, reason: str) -> None:
    with pytest.raises(ParameterError, match=reason):
        prove_cycle(axis, controller)
