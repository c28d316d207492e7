"""``furuta tune``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from furuta.studies.tuning.plan import TuningPlan, TuningResult
from furuta_bringup.option_types import PATH, FiniteRange
from furuta_bringup.options import (
    SIMULATED_SECONDS,
    joined_node,
    json_option,
    model_options,
    namespace_option,
    option,
)
from furuta_bringup.printing import print_json, show
from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError
from furuta_ros.whole_files import whole_file

if TYPE_CHECKING:
    from furuta.studies.tuning.tuning import ProgressCallback

# Each of the other compensations takes a trial of 12 s more.
DEFAULT = TuningPlan(seconds=240.0, rivals=True)
GUARD = FiniteRange(0, min_open=True)


@click.command()
@option(
    "--running",
    is_flag=True,
    help="Tune the running graph through its parameter services (default: a simulation).",
)
@namespace_option
@option(
    "--seconds",
    type=SIMULATED_SECONDS,
    default=DEFAULT.seconds,
    help="Total time of all trials [s].",
)
@option(
    "--arm-guard",
    type=GUARD,
    default=DEFAULT.arm_guard,
    help="Largest peak-to-peak excursion of the arm [rad].",
)
@option(
    "--pendulum-guard",
    type=GUARD,
    default=DEFAULT.pendulum_guard,
    help="Largest angle of the pendulum [rad].",
)
@option("--out", type=PATH, metavar="FILE.yaml", help="Write the parameters to a parameter file.")
@model_options
@json_option
def command(
    running: bool,
    namespace: str,
    seconds: float,
    arm_guard: float,
    pendulum_guard: float,
    out: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Find the compensation with the smallest remaining limit cycle.

    The pendulum first swings without compensation, and the friction parameters are fitted to the
    friction that the estimator observes. Then trials optimise sigma1 of the LuGre compensator, and
    the other compensations are tried with the fitted friction. If the initial parameters or no
    compensation are better than all of these, they are the result. "gain" is then false in the
    JSON, and the exit status is still 0. On a running graph the result stays active. The initial
    parameters are restored if the motion leaves the guard, or at Ctrl-C.
    """
    from furuta.settings.settings import load_settings, loop
    from furuta.studies.tuning.tuning import tune_simulated

    plan = DEFAULT._replace(seconds=seconds, arm_guard=arm_guard, pendulum_guard=pendulum_guard)
    if running and (files or assignments):
        raise ParameterError("--running cannot be combined with --rig, --params or --set")
    if namespace and not running:
        raise ParameterError("--namespace needs --running")
    report = _reporter(quiet=as_json)
    if running:
        result = _tune_running(plan, namespace, report)
    else:
        result = tune_simulated(loop(load_settings(files, assignments)), plan, report)
    tuned = result.as_json()
    if out is not None:
        import yaml

        file = {"friction_observer": {"ros__parameters": tuned["parameters"]}}
        with whole_file(out) as new:
            new.write_text(yaml.safe_dump(file, sort_keys=False))
    if as_json:
        print_json(tuned)
        return
    motions = ("before", "uncompensated", "after")
    show({f"{name} [rad]": getattr(result, name).amplitude for name in motions}, as_json)
    about = {"pendulum time [s]": result.seconds, "search": tuned["search"]}
    show({**tuned["parameters"], **about}, as_json)
    if not result.gain:
        print(f"no gain: nothing is better than {result.after.observer.compensation} as it was")


def _tune_running(plan: TuningPlan, namespace: str, report: ProgressCallback) -> TuningResult:
    from furuta.studies.tuning.tuning import tune
    from furuta_bringup.graph.parameter_client import ParameterClient
    from furuta_bringup.tuning_client import EstimateBuffer, TuningClient, TuningInterruptedError
    from furuta_ros.process_end import StopSignal

    with joined_node("furuta_tune", namespace) as (node, executor):
        parameter_client, estimates = ParameterClient(node, executor), EstimateBuffer(node)
        client = TuningClient(parameter_client, estimates, executor, StopSignal())
        try:
            return tune(client, client.observer, client.estimator, plan, report)
        except TuningInterruptedError:
            raise UserError("interrupted; the initial parameters are restored") from None


def _reporter(quiet: bool) -> ProgressCallback:
    from rich.console import Console

    console = Console(stderr=True, quiet=quiet)

    def report(message: str, seconds: float) -> None:
        console.print(f"{seconds:6.1f} s  {message}", markup=False, highlight=False)

    return report
