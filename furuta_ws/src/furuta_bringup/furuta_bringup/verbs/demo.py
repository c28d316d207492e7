"""``furuta demo``."""

from __future__ import annotations

import json
from pathlib import Path
from shutil import rmtree
from typing import TYPE_CHECKING, Any

import click

from furuta_bringup.option_types import DIRECTORY
from furuta_bringup.options import MEASURED_SECONDS, json_option, model_options, option
from furuta_bringup.printing import draw, show, with_progress, with_status
from furuta_ros.whole_files import whole_file

if TYPE_CHECKING:
    from furuta.results.studies import Demo


@click.command()
@option(
    "--seconds",
    type=MEASURED_SECONDS,
    default=40.0,
    help="Simulated time per compensation [s]; of its end at most 30 s are measured.",
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

    demo = _run(load_settings(files, assignments), seconds, directory, quiet=as_json)
    with whole_file(directory / "summary.json") as new:
        new.write_text(json.dumps(demo.to_dict(), indent=2) + "\n", encoding="utf-8")
    show(demo, as_json)


def _run(settings: Any, seconds: float, directory: Path, quiet: bool) -> Demo:
    with with_status("loading", quiet):
        from furuta.results.studies import Demo
        from furuta.settings.settings import loop
        from furuta.studies.phases import PHASES, tuned_sigma1
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
    simulated = loop(settings)
    with workers() as pool:
        # In a simulation, which has the numbers of the graph; the first phases run meanwhile.
        tuning = pool.submit(tuned_sigma1, simulated)
        compile_nodes(pool, quiet)
        with ros_context(private=True):
            running = run_demo(settings, tuning.result, seconds, new)
            phases = list(with_progress("running", running, len(PHASES), quiet=quiet))
    with with_status("reading the bag, drawing", quiet):
        _clear(bag)
        new.rename(bag)
        new.parent.rmdir()
        figure = directory / "demo.png"
        more = {
            "tuned_parameters": {"compensation": "lugre", "sigma1": tuning.result()},
            "figure": str(figure),
            "bag": str(bag),
        }
        count = simulated.plant.sensors.encoder_count
        demo = Demo(read_recorded_run(bag), phases, count, more)
        draw(demo, figure)
    return demo


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
