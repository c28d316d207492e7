"""``furuta swing-up``."""

from pathlib import Path

import click

from furuta_bringup.options import SEED, figure_option, json_option, option, parameter_options
from furuta_bringup.printing import bar, show

DEFAULT_RIG = "paper_full_turn"


@click.command()
@option("--starts", type=click.IntRange(1, 100_000), default=100, help="Random starts.")
@option("--rig", default=DEFAULT_RIG, metavar="NAME", help="Name or file of a rig.")
@option("--seed", type=SEED, default=0, help="Seed of the starts.")
@option(
    "--knocks", is_flag=True, help="Also push the pendulum over every 10 s; it must swing up again."
)
@figure_option("Draw the pendulum's angle, the times until upright and the arm within its limits.")
@parameter_options
@json_option
def command(
    starts: int,
    rig: str,
    seed: int,
    knocks: bool,
    figure: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Swing up from random states, on plants up to 10 % off the model, without ROS.

    A start counts as upright if the pendulum is upright within 10 s and stays so. --knocks adds a
    run of 60 s on the model itself: pushes, falls, swing-ups after them, and the time upright.
    """
    from furuta import swing_up

    found = swing_up(
        starts,
        assignments,
        rig=rig,
        files=files,
        seed=seed,
        knocks=knocks,
        progress=bar("swinging up", as_json),
    )
    show(found, as_json, figure)
