"""``furuta identify``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
import numpy as np
import yaml

from furuta_cli.options import FiniteRange, json_option, print_json
from furuta_identification.fitting.fit import identify
from furuta_identification.fitting.model import Model
from furuta_identification.fitting.report import node_parameters, summary
from furuta_identification.preparation.consistency import ANGLES
from furuta_identification.preparation.pieces import pieces
from furuta_identification.preparation.preparation import ZEROS, Options
from furuta_identification.uncertainty.quality import Followed, follow, held_out
from furuta_recordings.readers import Mapping, read
from furuta_recordings.recording import Recording

# Fit over the first seconds, beside that over the whole.
FIRST_SECONDS = 3.0


@click.command()
@click.argument(
    "paths", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="PATH..."
)
@click.option("--arm", help="Joint that is the arm.")
@click.option("--pendulum", help="Joint that is the pendulum.")
@click.option("--command", "command_name", help="Topic or column of the command; or: effort.")
@click.option("--states", help="Topic of the joints' states.")
@click.option(
    "--zero",
    type=click.Choice(ZEROS),
    default="auto",
    show_default=True,
    help="Where the pendulum's angle is 0.",
)
@click.option(
    "--angles",
    type=click.Choice(ANGLES),
    default="auto",
    show_default=True,
    help="Unit of the angles.",
)
@click.option(
    "--command-scale",
    type=FiniteRange(),
    default=1.0,
    metavar="V",
    help="Volts per unit of the command; default: 1.",
)
@click.option(
    "--window",
    type=FiniteRange(0.05, 1e4),
    help="Length of a free simulation [s]; default: the whole recording, or 0.5.",
)
@click.option(
    "--validate",
    multiple=True,
    type=click.Path(path_type=Path),
    metavar="PATH",
    help="Recording for validation, not used for the fit; repeatable.",
)
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE.png", help="Draw residuals.")
@click.option(
    "--write",
    type=click.Path(path_type=Path),
    metavar="FILE.yaml",
    help="Parameter file for the nodes.",
)
@json_option
def command(
    paths: tuple[Path, ...],
    arm: str | None,
    pendulum: str | None,
    command_name: str | None,
    states: str | None,
    zero: str,
    angles: str,
    command_scale: float,
    window: float | None,
    validate: tuple[Path, ...],
    out: Path | None,
    write: Path | None,
    as_json: bool,
) -> None:
    """Fit the model to recordings: bags, CSV tables, or files of `simulate --out`.

    Several recordings of one rig are fitted together. Parameters that the data do not determine
    are reported with the reason instead of a number.
    """
    mapping = Mapping(arm, pendulum, command_name, states)
    if command_scale == 0.0:
        raise click.UsageError("--command-scale must not be 0")
    options = Options(zero, window, angles, command_scale)
    recordings, findings = _read_all(paths, mapping)
    model = identify(recordings, options)
    followed = [follow(model, each) for each in model.recordings]
    tried, more = _read_all(validate, mapping)
    findings += more
    others = []
    for recording in tried:
        for piece in pieces(recording)[0]:
            other, more = held_out(model, piece, options)
            others.append(other)
            findings += more
    result = _result(model, followed, others, findings)
    if out is not None:
        from furuta_figures.residual import draw_residuals

        draw_residuals(followed, others, out)
        result["figure"] = str(out)
    if write is not None:
        write.write_text(_parameter_file(model, result))
        result["parameter_file"] = str(write)
    if as_json:
        print_json(result)
    else:
        _print(result)


def _read_all(paths: tuple[Path, ...], mapping: Mapping) -> tuple[list[Recording], list[str]]:
    """The recordings, each with a unique name, and how their columns were interpreted."""
    recordings, findings = [], []
    for path in paths:
        recording, found = read(path, mapping)
        same = sum(other.name == path.name for other in paths) > 1
        recordings.append(recording._replace(name=str(path)) if same else recording)
        findings += found
    return recordings, findings


def _result(
    model: Model, followed: list[Followed], others: list[Followed], findings: list[str]
) -> dict[str, Any]:
    result = summary(model)
    result["findings"] = findings + result["findings"]
    result["fit"] = {each.recording.name: _fits(each) for each in followed}
    result["held_out"] = {each.recording.name: _fits(each) for each in others}
    result["regression"] = {
        name: value
        for name, value in model.regression._asdict().items()
        if name != "standard_errors"
    }
    return result


def _fits(each: Followed) -> dict[str, float]:
    fits = {name.replace(" ", "_"): value for name, value in each.fits().items()}
    first = each.fits(FIRST_SECONDS)["pendulum angle"]
    return {**fits, "pendulum_angle_first_3_s": first}


def _parameter_file(model: Model, result: dict[str, Any]) -> str:
    missing = [
        f"# {name}: not determined by the data: {why}"
        for name, why in result["undetermined"].items()
    ]
    head = ["# Identified; load with --params.", *missing]
    return "\n".join(head) + "\n" + yaml.safe_dump(node_parameters(model), sort_keys=False)


def _print(result: dict[str, Any]) -> None:
    errors = result["standard_errors"]
    for group in (result, result["lugre"], result["setup"]):
        for name, value in group.items():
            if isinstance(value, (float, np.floating)) and name in errors:
                error = errors[name]
                print(f"{name:26} {value:12.6g}" + (f"  ± {error:.2g}" if error else ""))
    for name, why in result["undetermined"].items():
        print(f"{name:26} not determined by the data: {why}")
    for kind in ("fit", "held_out"):
        for recording, fits in result[kind].items():
            known = {n: v for n, v in fits.items() if not np.isnan(v)}
            listed = ", ".join(f"{n.replace('_', ' ')} {v:.1f} %" for n, v in known.items())
            print(f"{kind.replace('_', '-')} {recording}: {listed}")
    for finding in result["findings"]:
        print(f"found: {finding}")
    for name in ("figure", "parameter_file"):
        if name in result:
            print(f"{name.replace('_', ' ')}: {result[name]}")
