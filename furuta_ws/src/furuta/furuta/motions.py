"""Simulates loops and tunes them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from furuta.loops import Part, checked_loop, with_parts
from furuta.outcomes import Outcome, outcome
from furuta.results.motion import Run
from furuta.studies.tuning_plan import TuningPlan
from furuta_model.parameters import ParameterError
from furuta_model.progress import Progress, unseen
from furuta_ros.time_stamps import MOST_SECONDS
from furuta_sim.simulation import closed_loop
from furuta_sim.simulation.closed_loop import Loop

if TYPE_CHECKING:
    from furuta.results.studies import Tuning


def simulate(
    loop: Loop | None = None,
    seconds: float = 60.0,
    *,
    progress: Progress = unseen,
    **parts: Part | None,
) -> Run:
    """Simulate a loop sample by sample, with its sensors and drive, from its initial state.

    Args:
        loop: The loop; by default that of the paper.
        seconds: Simulated time [s], at least one sample.
        progress: Gets the parts of the run and their number, and yields them as they are simulated.
        parts: Functions of your own (docs/library.md): ``friction`` g(v, p) or a
            :class:`furuta.Law`, ``compensation`` F̂(memory, x, p), ``controller`` u(memory, x, F̂, p)
            [V], and ``estimator`` (memory, x, measurement, p), which changes x.

    Returns:
        Series of n samples: ``time`` (n,) [s], ``state`` (n, 4) [rad, rad/s], ``estimate`` (n, 5),
        ``friction``, ``friction_estimate`` and ``command`` (n,) [V]; ``measurement`` (n, 5), NaN
        where there is no sensor.

    Raises:
        ParameterError: ``seconds`` is not above 0, or above 1e6, a part cannot be compiled, or the
            series do not fit into memory.
    """
    check_seconds(seconds)
    simulated = with_parts(loop, **parts)
    try:
        return Run(*closed_loop.simulate(simulated, seconds, progress), simulated)
    except MemoryError:
        reason = f"the series of {seconds:g} s do not fit into memory; measure() keeps none"
        raise ParameterError(reason) from None


def measure(
    loop: Loop | None = None, seconds: float = 60.0, settled: float = 0.5, **parts: Part | None
) -> Outcome:
    """Simulate a loop and measure its oscillation, without keeping the series.

    Args:
        loop: The loop; by default that of the paper.
        seconds: Simulated time [s], at least one sample.
        settled: Fraction of the run that is measured, at its end; above 0, at most 1.
        parts: As for :func:`simulate`.

    Returns:
        Peak to peak of arm and pendulum [rad], period [s], rms of command [V], and whether the
        pendulum fell.

    Raises:
        ParameterError: ``seconds`` or ``settled`` is outside its range, or a part cannot be
            compiled.
    """
    check_seconds(seconds)
    if not 0.0 < settled <= 1.0:
        raise ParameterError(f"settled must be above 0 and at most 1, given {settled:g}")
    return outcome(with_parts(loop, **parts), seconds, settled)


def tune(
    loop: Loop | None = None,
    seconds: float = 120.0,
    report: Callable[[str, float], None] | None = None,
    enough: float = 1.0,
    arm_guard: float = 1.0,
    pendulum_guard: float = 0.4,
) -> Tuning:
    """Find the compensation with the smallest swing of the arm, by simulation.

    Args:
        loop: The loop; by default that of the paper. Its plant is the truth, which the tuning sees
            only through the estimates.
        seconds: Longest simulated time [s].
        report: Called with a message and the simulated time [s]; by default nothing is reported.
        enough: Swing that ends the search, in counts of the encoder.
        arm_guard: Largest peak-to-peak excursion of the arm [rad].
        pendulum_guard: Largest angle of the pendulum [rad].

    Returns:
        The trials ``before`` and ``after``, each with its ``compensation`` (parameters of
        estimator, friction observer and controller) and the arm's ``swing`` [rad]; all ``trials``;
        the ``parameters`` that changed, by node; whether there is a ``gain``.

    Raises:
        ParameterError: The time is too short, or the pendulum falls.
    """
    from furuta.results.studies import Tuning
    from furuta.studies.tuning import tune_simulated

    check_seconds(seconds)
    plan = TuningPlan(seconds, arm_guard, pendulum_guard, enough)
    found = tune_simulated(checked_loop(loop), plan, report or (lambda text, time: None))
    return Tuning(**vars(found))


def check_seconds(seconds: float) -> None:
    """Reject a simulated time [s] that is out of its range."""
    if not 0.0 < seconds <= MOST_SECONDS:
        limits = f"above 0 and at most {MOST_SECONDS:g}"
        raise ParameterError(f"seconds must be {limits}, given {seconds:g}")
