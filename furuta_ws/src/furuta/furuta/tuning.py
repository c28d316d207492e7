"""Tunes the friction compensation of a simulated loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Loop

if TYPE_CHECKING:
    from furuta.studies.tuning.result import TuningResult
    from furuta.studies.tuning.tuning import ProgressCallback


def tune(
    loop: Loop | None = None,
    seconds: float = 240.0,
    report: ProgressCallback | None = None,
) -> TuningResult:
    """Find the compensation with the smallest remaining limit cycle, by simulation.

    Args:
        loop: The loop; by default that of the paper. Its plant is the truth, which the tuning sees
            only through the estimates.
        seconds: Total simulated time [s].
        report: Called with a message and the simulated time [s]; by default nothing is reported.

    Returns:
        The best trial ``after``, with its ``observer`` parameters and the arm's peak to peak
        ``amplitude`` [rad]; the trials ``before`` and ``uncompensated``; whether there is a
        ``gain``.

    Raises:
        ParameterError: The time is too short, or the loop cannot be tuned.
    """
    from furuta.studies.tuning.plan import RIVALS
    from furuta.studies.tuning.simulated_tuning import PLAN
    from furuta.studies.tuning.tunable_loop import GuardError, SimulatedLoop
    from furuta.studies.tuning.tuning import tune as run_tuning

    loop = loop or Loop()
    plan = PLAN._replace(seconds=seconds, rivals=RIVALS)
    try:
        return run_tuning(
            SimulatedLoop(loop), loop.observer, loop.estimator, plan, report or _no_report
        )
    except (GuardError, ValueError) as error:
        raise ParameterError(f"cannot tune the compensation of this loop: {error}") from None


def _no_report(message: str, seconds: float) -> None:
    """Report nothing."""
