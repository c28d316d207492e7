"""``furuta tune``."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from furuta.studies.tuning_plan import TuningPlan
from furuta_bringup.option_types import PARAMETER_FILE, FiniteRange
from furuta_bringup.options import (
    SIMULATED_SECONDS,
    figure_option,
    json_option,
    model_options,
    namespaced,
    option,
)
from furuta_bringup.printing import show, with_status
from furuta_ros.whole_files import whole_file

DEFAULT = TuningPlan()
GUARD = FiniteRange(0, min_open=True)


@click.command()
@option(
    "--running",
    is_flag=True,
    not_with=("--rig", "--params", "--set", "--own-parts"),
    help="Tune the running graph through its parameter services (default: a simulation).",
)
@namespaced(needs=("--running",))
@option(
    "--seconds",
    type=SIMULATED_SECONDS,
    default=DEFAULT.seconds,
    help="Longest pendulum time of all trials [s].",
)
@option(
    "--follow",
    type=FiniteRange(0),
    default=0.0,
    needs=("--running",),
    help="Watch the swing of the running graph for this pendulum time [s] after that, and search "
    "again whenever it has grown.",
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
@option("--out", type=PARAMETER_FILE, help="Write the parameters to a parameter file.")
@figure_option("Draw the swing of each trial.")
@model_options
@json_option
def command(
    running: bool,
    namespace: str,
    seconds: float,
    follow: float,
    arm_guard: float,
    pendulum_guard: float,
    out: Path | None,
    figure: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Find the compensation with the smallest swing of the arm.

    The recommended setting is tried with other bandwidths and other lags of the drive, until the
    arm swings by at most one count of its encoder. Where the swing grows, the best setting so far
    is restored at once. If
    nothing is better than the motion as it was, nothing changes; "gain" is then false in the JSON,
    and the exit status is still 0. On a running graph the result stays active. Ctrl-C restores the
    initial parameters.
    """
    from furuta import make_loop, tune

    report = _quiet if as_json else _report
    guards = {"arm_guard": arm_guard, "pendulum_guard": pendulum_guard}
    with with_status("tuning", as_json):
        if running:
            from furuta_bringup.tuning_client import tune_running

            plan = DEFAULT._replace(seconds=seconds, **guards)
            tuned = tune_running(namespace, plan, report, follow)
        else:
            tuned = tune(make_loop(assignments, files=files), seconds, report, **guards)
    try:
        if out is not None:
            import yaml

            file = {node: {"ros__parameters": of} for node, of in tuned.parameters.items() if of}
            with whole_file(out) as new:
                new.write_text(yaml.safe_dump(file, sort_keys=False), encoding="utf-8")
    finally:  # also if that fails
        show(tuned, as_json, figure)


def _report(message: str, seconds: float) -> None:
    print(f"{seconds:6.1f} s  {message}", file=sys.stderr)


def _quiet(message: str, seconds: float) -> None:
    """Report nothing."""
