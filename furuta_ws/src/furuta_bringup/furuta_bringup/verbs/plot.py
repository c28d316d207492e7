"""``furuta plot``."""

from pathlib import Path

import click

from furuta_bringup.file_types import FIGURE, PATH
from furuta_bringup.options import json_option, names_options, option
from furuta_bringup.printing import show
from furuta_recordings.readers import Mapping


@click.command()
@click.argument("recording", type=PATH, metavar="BAG|FILE")
@option("--out", type=FIGURE, required=True, help="Picture to write.")
@names_options
@json_option
def command(recording: Path, out: Path, names: Mapping, as_json: bool) -> None:
    """Draw arm, pendulum, control and friction over time.

    BAG is a recording; FILE is what `simulate --out` or `bag export` wrote, or a CSV table of
    another rig.
    """
    from furuta.figures.series import draw_series
    from furuta.studies.series import load_series
    from furuta_recordings.series_columns import TIME

    series = load_series(recording, names)
    draw_series(series, out)
    samples = len(series[TIME])
    show({"figure": str(out), "samples": samples, "columns": list(series)}, as_json)
