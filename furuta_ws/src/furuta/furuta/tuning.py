"""Tunes the friction compensation of a simulated loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
    from furuta.studies.tuning.plan import RIVALS, SIMULATED
    from furuta.studies.tuning.tuning import tune_simulated

    plan = SIMULATED._replace(seconds=seconds, rivals=RIVALS)
    return tune_simulated(loop or Loop(), plan, report or (lambda message, seconds: None))
