"""``furuta demo``."""

import json
from pathlib import Path
from shutil import rmtree
from typing import Any

import click

from furuta_bringup.option_types import DIRECTORY
from furuta_bringup.options import MEASURED_SECONDS, json_option, model_options, option
from furuta_bringup.printing import print_json, print_table, show, with_progress, with_status
from furuta_ros.whole_files import whole_file

TITLE = "limit cycle, peak to peak, last quarter of each phase"
HEADINGS = {
    "compensation": "compensation",
    "phi_peak_to_peak_rad": "arm [rad]",
    "theta_peak_to_peak_rad": "pendulum [rad]",
    "period_s": "period [s]",
    "command_rms_v": "u rms [V]",
    "samples": "samples",
    "wall_seconds": "took [s]",
}


@click.command()
@option(
    "--seconds", type=MEASURED_SECONDS, default=20.0, help="Simulated time per compensation [s]."
)
@option(
    "--out",
    "directory",
    default="output/demo",
    type=DIRECTORY,
    help="Directory for figure, bag and summary.json. Files of an earlier demo are replaced.",
)
@model_options
@json_option
def command(
    seconds: float,
    directory: Path,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compare the paper's compensations and the recommended one on the real node graph.

    The graph runs in lock-step in one process and is recorded. Parameter services tune
    the compensator and switch between the compensations.
    """
    from furuta.settings.settings import load_settings

    settings = load_settings(files, assignments)
    summary = _run(settings, seconds, directory, quiet=as_json)
    with whole_file(directory / "summary.json") as new:
        new.write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    if as_json:
        print_json(summary)
    else:
        print_table(TITLE, summary["runs"], HEADINGS)
        show({name: summary[name] for name in ("figure", "bag")}, as_json)


def _run(settings: Any, seconds: float, directory: Path, quiet: bool) -> dict[str, Any]:
    with with_status("loading", quiet):
        from furuta.figures.series import draw_demo
        from furuta.settings.settings import loop
        from furuta.studies.phases import COMPENSATIONS, evaluate, tuned_sigma1
        from furuta_bringup.demo_run import run_demo
        from furuta_bringup.warm_up import compile_nodes, workers
        from furuta_recordings.bags.recorded_loop import read_recorded_run
        from furuta_recordings.bags.writer import check_new_bag
        from furuta_ros.spinning import ros_context

    # An interrupted demo leaves the results of an earlier one as they were.
    bag, new = directory / "bag", directory / "unfinished" / "bag"
    _check(bag)
    _clear(new)
    check_new_bag(new)
    with workers() as pool:
        # In a simulation, which has the numbers of the graph; the first phases run meanwhile.
        tuning = pool.submit(tuned_sigma1, loop(settings))
        compile_nodes(pool, quiet)
        with ros_context(private=True):
            running = run_demo(settings, tuning.result, seconds, new)
            phases = list(with_progress("running", running, len(COMPENSATIONS), quiet=quiet))
    with with_status("reading the bag, drawing", quiet):
        _clear(bag)
        new.rename(bag)
        new.parent.rmdir()
        recorded = read_recorded_run(bag)
        figure = directory / "demo.png"
        draw_demo(recorded, phases, figure)
    return {
        "runs": evaluate(phases, recorded),
        "tuned_parameters": {"compensation": "lugre", "sigma1": tuning.result()},
        "figure": str(figure),
        "bag": str(bag),
    }


def _check(bag: Path) -> None:
    """Refuse a directory that contains anything but a bag."""
    for file in bag.glob("*"):
        if file.suffix not in (".mcap", ".yaml"):
            raise click.ClickException(
                f"{bag} contains {file.name}, which does not belong to a bag"
            )


def _clear(bag: Path) -> None:
    """Remove the bag of an earlier demo."""
    _check(bag)
    if bag.exists():
        rmtree(bag)
