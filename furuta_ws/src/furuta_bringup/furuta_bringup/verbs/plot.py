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
    from furuta.studies.series import series_with_findings
    from furuta_recordings.series_columns import TIME

    series, findings = series_with_findings(recording, names)
    draw_series(series, out)
    result = {"figure": str(out), "samples": len(series[TIME]), "columns": list(series)}
    show(result | {"findings": findings}, as_json)
