"""``furuta swing-up``."""

from pathlib import Path

import click

from furuta_bringup.options import SEED, json_option, option, parameter_options
from furuta_bringup.printing import show, with_progress, with_status

DEFAULT_RIG = "paper_full_turn"


@click.command()
@option("--starts", type=click.IntRange(1, 100_000), default=100, help="Random starts.")
@option("--rig", default=DEFAULT_RIG, metavar="NAME", help="Name or file of a rig.")
@option("--seed", type=SEED, default=0, help="Seed of the starts.")
@option(
    "--knocks", is_flag=True, help="Also push the pendulum over every 10 s; it must swing up again."
)
@parameter_options
@json_option
def command(
    starts: int,
    rig: str,
    seed: int,
    knocks: bool,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Swing up from random states, on plants up to 10 % off the model, without ROS.

    A start counts as upright if the pendulum is upright within 10 s and stays so. --knocks adds a
    run of 60 s on the model itself: pushes, falls, swing-ups after them, and the time upright.
    """
    from furuta.settings.settings import load_settings, loop
    from furuta.studies import swing_up
    from furuta_hw.rigs.known_rigs import find_rig

    with with_status("loading", as_json):
        given = load_settings(files, assignments, swing_up.swing_up_settings(find_rig(rig)))
        nominal = loop(given)
        drawn = swing_up.random_starts(nominal, starts, seed)
    runs = swing_up.run_starts(drawn)
    report = swing_up.summary(list(with_progress("starting", runs, starts, as_json)))._asdict()
    if knocks:
        report |= swing_up.run_knocks(nominal)._asdict()
    show(report, as_json)
