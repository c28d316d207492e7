"""``furuta map``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.progress import track

from furuta.studies.analysis_options import AnalysisOptions
from furuta.studies.feedback_map import MapPoint, map_feedbacks
from furuta.studies.parameter_range import parse_range
from furuta.studies.study_tables import write_csv
from furuta_bringup.file_types import FIGURE
from furuta_bringup.options import ideal_options, json_option, model_options, print_json
from furuta_model.parameters import ParameterError

DEFAULT_COUNT = 20


@click.command()
@click.argument("ranges", nargs=2, metavar="NAME=LOW:HIGH[:COUNT] NAME=LOW:HIGH[:COUNT]")
@ideal_options
@click.option("--out", type=FIGURE, help="Draw the map.")
@click.option("--data", type=click.Path(path_type=Path), metavar="FILE.csv", help="Write the rows.")
@model_options
@json_option
def command(
    ranges: tuple[str, str],
    law: str | None,
    feedback: tuple[float, float, float, float] | None,
    out: Path | None,
    data: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Map the limit cycle over two parameters: where it exists, and its amplitude.

    A parameter is given by its name or as a gain l1 to l4 of u = l·x.

    Example: furuta map omega1=2:12 omega2=2:12
    """
    options = AnalysisOptions(files, assignments, law, feedback)
    (first, firsts), (second, seconds) = (parse_range(each, DEFAULT_COUNT) for each in ranges)
    if first == second:
        raise ParameterError(f"a map needs two different parameters, given {first} twice")
    points = map_feedbacks(lambda a, b: options.ideal_loop({first: a, second: b}), firsts, seconds)
    total = len(firsts) * len(seconds)
    console = Console(stderr=True, quiet=as_json or not sys.stderr.isatty())
    found = list(track(points, "mapping", total=total, console=console, transient=True))
    rows = [_row(first, second, point) for point in found]
    if data is not None:
        write_csv(rows, data)
    if out is not None:
        from furuta.figures.feedback_map import draw_map

        draw_map(first, second, firsts, seconds, found, out)
    if as_json:
        print_json({"rows": rows})
    else:
        kinds = [point.cycle.kind for point in found]
        for kind in sorted(set(kinds)):
            print(f"{kind:24} {kinds.count(kind)} of {total}")


def _row(first: str, second: str, point: MapPoint) -> dict[str, Any]:
    cycle = point.cycle
    return {
        first: float(point.first),
        second: float(point.second),
        "kind": cycle.kind,
        "phi_peak_to_peak_rad": cycle.phi_peak_to_peak_rad,
        "theta_peak_to_peak_rad": cycle.theta_peak_to_peak_rad,
        "period_s": cycle.period_s,
        "rotation_rate_rad_s": cycle.rotation_rate_rad_s,
        "stable": cycle.stable,
        "predicted_phi_peak_to_peak_rad": point.predicted_phi_peak_to_peak_rad,
    }
