"""Batches: a run has the same outcome in any batch."""

from collections.abc import Iterator

import numpy as np
import pytest

from furuta.lanes.batch import batch
from furuta.oscillation import measure_oscillation
from furuta.outcomes import Outcome, outcome
from furuta_control.control import ControllerParameters
from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.parameters import Friction
from furuta_model.state import PHI
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate

SECONDS = 3.0


def loops(count: int) -> list[Loop]:
    """Runs that differ in all kinds of parameters."""
    return [
        Loop(
            PlantParameters(
                friction=PlantFriction(parameters=Friction(alpha0=0.1 + 0.01 * k)), seed=k
            ),
            observer=ObserverParameters(compensation=("none", "coulomb", "lugre")[k % 3]),
        )
        for k in range(count)
    ]


def bits(outcomes: Iterator[Outcome] | list[Outcome]) -> list[bytes]:
    """Outcomes to the last bit, with NaN."""
    return [np.array([*vars(each).values()], dtype=float).tobytes() for each in outcomes]


def test_outcomes_depend_on_their_own_parameters_alone() -> None:
    """Not on the number of workers, nor on the size and order of the batch."""
    alone = bits([outcome(loop, SECONDS) for loop in loops(23)])
    assert len(set(alone)) == 23
    assert bits(batch(loops(23), SECONDS, workers=1)) == alone
    assert bits(batch(loops(23)[::-1], SECONDS, workers=5)) == alone[::-1]
    assert bits(batch(loops(4), SECONDS, workers=2)) == alone[:4]


@pytest.mark.parametrize("kind", ["none", "lugre"])
def test_outcome_equals_that_of_the_series(kind: str) -> None:
    """Values measured during the run equal those computed from the recorded series."""
    loop = Loop(observer=ObserverParameters(compensation=kind))
    found, record = outcome(loop, 40.0), simulate(loop, 40.0)
    half = slice(len(record.command) // 2, None)
    expected = measure_oscillation(record.state[half], record.sample_time)
    assert found.phi_peak_to_peak_rad == expected.phi_peak_to_peak_rad
    assert found.theta_peak_to_peak_rad == expected.theta_peak_to_peak_rad
    assert found.stuck_fraction == expected.stuck_fraction
    assert found.steps == len(record.command) == 40_000
    error = record.friction[half] - record.friction_estimate[half]
    for rms, series in (
        (found.phi_rms_rad, record.state[half, PHI]),
        (found.command_rms_v, record.command[half]),
        (found.friction_error_rms_v, error),
    ):
        assert rms == pytest.approx(np.sqrt(np.mean(series**2)), rel=1e-12)
    if kind == "none":
        # The midpoint comes from an earlier part of the run and differs by a few milliradians.
        assert found.period_s == pytest.approx(expected.period_s, rel=1e-3)


def test_failure_of_a_run_is_raised() -> None:
    """And does not block the other runs."""
    impossible = Loop()._replace(controller=ControllerParameters(gain=(1.0,)))
    with pytest.raises(ValueError, match="unpack"):
        list(batch([Loop(), impossible, Loop()], 0.01))
