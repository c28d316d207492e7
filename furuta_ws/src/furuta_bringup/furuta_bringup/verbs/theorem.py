"""``furuta theorem``."""

from pathlib import Path

import click

from furuta.axis.theorems import THEOREMS, theorem
from furuta_bringup.file_types import FIGURE
from furuta_bringup.options import SEED, json_option
from furuta_bringup.printing import show


@click.command()
@click.argument("name", type=click.Choice(list(THEOREMS)))
@click.option(
    "--loops",
    type=click.IntRange(1, 1_000_000),
    default=100,
    show_default=True,
    help="Random loops of coulomb, stiction and pendulum.",
)
@click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the random loops.")
@click.option("--out", type=FIGURE, help="Draw the atlas of hunting, with its fold.")
@json_option
def command(name: str, loops: int, seed: int, out: Path | None, as_json: bool) -> None:
    """Check a theorem on limit cycles of an axis with friction by exact cycles.

    The table has its source, its statement, what was found, and whether that agrees.
    """
    if out is not None and name != "fold":
        raise click.UsageError("--out needs the theorem fold")
    show(theorem(name, loops, seed), as_json)
    if out is not None:
        from furuta.axis.folds import atlas
        from furuta.figures.atlas import draw_atlas

        draw_atlas(atlas(), out)
