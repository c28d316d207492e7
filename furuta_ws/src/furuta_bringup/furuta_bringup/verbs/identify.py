"""``furuta identify``."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
from rich.console import Console

from furuta_bringup.file_types import FIGURE
from furuta_bringup.number_types import FiniteRange, NonZero
from furuta_bringup.options import json_option, print_json
from furuta_hw.rigs.rig import Rig
from furuta_identification.fitting.free_swing import identify_free_swing
from furuta_identification.fitting.friction_laws import compare_laws, simplest_adequate_law
from furuta_identification.fitting.identifiability import undetermined
from furuta_identification.fitting.identify import identify
from furuta_identification.fitting.model import Model
from furuta_identification.fitting.report import summary
from furuta_identification.fitting.validation import Prediction, predict_prepared, validate
from furuta_identification.fitting.verdict import verdict
from furuta_identification.preparation.options import ANGLE_UNITS, AUTO_DIRECTION, ZEROS, Options
from furuta_model.parameters import ParameterError
from furuta_recordings.readers import Mapping, read
from furuta_recordings.readers.mapping import NO_COMMAND
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import split_into_runs
from furuta_sim.settings.rigs import find_rig

# Duration [s] at the start over which the fit is given too.
FIRST_SECONDS = 3.0
DIRECTIONS = {"auto": AUTO_DIRECTION, "1": 1.0, "-1": -1.0}


class Zero(click.ParamType):
    """A position by name, or an angle in degrees, which becomes radians."""

    name = "zero"

    def convert(self, value: Any, param: Any, context: Any) -> str | float:
        """The name, or the angle [rad]."""
        if value in ZEROS or isinstance(value, float):
            return value  # type: ignore[no-any-return]
        try:
            angle = float(value)
        except ValueError:
            angle = np.nan
        if not np.isfinite(angle):
            self.fail(f"'{value}' is not one of {', '.join(ZEROS)} or an angle in degrees", param)
        return float(np.radians(angle))


@click.command()
@click.argument(
    "paths", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="PATH..."
)
@click.option("--arm", help="Name of the arm's joint.")
@click.option("--pendulum", help="Name of the pendulum's joint.")
@click.option(
    "--command",
    "command_name",
    help="Topic or column of the command, `effort` for the arm's effort, or `none` for free swings "
    "of the pendulum with a held arm.",
)
@click.option("--states", help="Topic of the joint states.")
@click.option("--time", help="Column of a table's time.")
@click.option(
    "--zero",
    type=Zero(),
    default="auto",
    show_default=True,
    help="Pendulum position at which the angle is 0 (auto, upright, hanging), or the measured "
    "angle of the hanging pendulum in degrees.",
)
@click.option(
    "--direction",
    type=click.Choice(DIRECTIONS),
    default="auto",
    show_default=True,
    help="Direction of the pendulum's angle: 1 if an upright pendulum falls in its negative "
    "direction when the arm accelerates in its positive one.",
)
@click.option(
    "--angles",
    type=click.Choice(ANGLE_UNITS),
    default="auto",
    show_default=True,
    help="Unit of the angles.",
)
@click.option(
    "--command-scale",
    type=NonZero(),
    default=1.0,
    show_default=True,
    metavar="V",
    help="Voltage that a command of 1 stands for [V].",
)
@click.option(
    "--ceiling",
    type=FiniteRange(0.0, 1e3, min_open=True),
    metavar="V",
    help="Highest voltage of the drive [V]; default: found, if the data show it.",
)
@click.option(
    "--window",
    type=FiniteRange(0.05, 1e4),
    help="Length of the segments that are simulated [s]; default: the whole recording, or 0.5 for "
    "a balanced pendulum.",
)
@click.option(
    "--validate",
    "validation_paths",
    multiple=True,
    type=click.Path(path_type=Path),
    metavar="PATH",
    help="Recording to test the model on, which is not used for the fit; repeatable.",
)
@click.option(
    "--laws",
    is_flag=True,
    help="Compare laws of the arm's friction by their predictions of held-out recordings, or of "
    "held-out halves of a single one.",
)
@click.option("--out", type=FIGURE, help="Draw the residuals.")
@click.option(
    "--write",
    type=click.Path(path_type=Path),
    metavar="FILE.yaml",
    help="Write a rig file, for --rig of other verbs.",
)
@click.option(
    "--rig",
    "base",
    default="",
    metavar="NAME|FILE",
    help="Rig whose sensors, line and limits the written rig has; default: according to the "
    "recording.",
)
@json_option
def command(
    paths: tuple[Path, ...],
    arm: str | None,
    pendulum: str | None,
    command_name: str | None,
    states: str | None,
    time: str | None,
    zero: str | float,
    direction: str,
    angles: str,
    command_scale: float,
    ceiling: float | None,
    window: float | None,
    validation_paths: tuple[Path, ...],
    laws: bool,
    out: Path | None,
    write: Path | None,
    base: str,
    as_json: bool,
) -> None:
    """Fit the model to recordings: bags, CSV tables, or files of `simulate --out`.

    Several recordings of one rig are fitted together. Parameters that the data do not determine are
    withheld, with the reason.
    """
    mapping = Mapping(arm, pendulum, command_name, states, time)
    options = Options(zero, window, angles, command_scale, float(DIRECTIONS[direction]), ceiling)
    if base and write is None:
        raise ParameterError("--rig is the rig that --write completes; give --write too")
    if command_name == NO_COMMAND:
        if out or write or validation_paths or laws:
            raise ParameterError("free swings give no model: no --out, --write, --validate, --laws")
        _free_swing(paths, mapping, options, as_json)
        return
    given = find_rig(base) if base else None
    console = Console(stderr=True)
    with console.status("reading") as status:
        # Without a terminal there is no line to update: a line for each stage.
        options = options._replace(report=status.update if console.is_terminal else console.print)
        identified = _identify(paths, validation_paths, mapping, options)
        compared = compare_laws(identified.model, options.report) if laws else []
    result = _result(identified)
    if laws:
        result["friction_laws"] = [each._asdict() for each in compared]
        result["simplest_adequate_law"] = simplest_adequate_law(compared).law
    if out is not None:
        from furuta.figures.residual import draw_residuals

        draw_residuals(identified.fitted, identified.held_out, out)
        result["figure"] = str(out)
    if write is not None:
        found = _write_rig(identified, write, given, paths[0])
        result["findings"] += found
        result["rig_file"] = str(write)
    if as_json:
        print_json(result)
    else:
        _print(result)


def _free_swing(paths: tuple[Path, ...], mapping: Mapping, options: Options, as_json: bool) -> None:
    """Fit and print the pendulum's own motion."""
    recordings, notes = _read_all(paths, mapping)
    found = identify_free_swing(recordings, options)
    findings = [*notes, *found.findings]
    if as_json:
        errors = {"standard_errors": found.standard_errors}
        print_json({**found.values, **errors, "fit": found.fit, "findings": findings})
        return
    for name, value in found.values.items():
        print(f"{name:26} {value:12.6g}  ± {found.standard_errors[name]:.2g}")
    for name, fit in found.fit.items():
        print(f"fit {name}: pendulum angle {fit:.1f} %")
    for finding in findings:
        print(f"found: {finding}")


class Identified(NamedTuple):
    """A model, its predictions of fitted and of held-out recordings, and findings of reading."""

    model: Model
    fitted: list[Prediction]
    held_out: list[Prediction]
    findings: list[str]


def _identify(
    paths: tuple[Path, ...],
    validation_paths: tuple[Path, ...],
    mapping: Mapping,
    options: Options,
) -> Identified:
    recordings, findings = _read_all(paths, mapping)
    model = identify(recordings, options)
    fitted = [predict_prepared(model, each) for each in model.recordings]
    others, more = _read_all(validation_paths, mapping)
    findings += more
    held_out = []
    for recording in others:
        for run in split_into_runs(recording)[0]:
            prediction, more = validate(model, run, options)
            held_out.append(prediction)
            findings += more
    return Identified(model, fitted, held_out, findings)


def _read_all(paths: tuple[Path, ...], mapping: Mapping) -> tuple[list[Recording], list[str]]:
    """The recordings, each with a unique name, and how their content was interpreted."""
    recordings, findings = [], []
    for path in paths:
        recording, found = read(path, mapping)
        same = sum(other.name == path.name for other in paths) > 1
        recordings.append(recording._replace(name=str(path)) if same else recording)
        findings += found
    return recordings, findings


def _result(identified: Identified) -> dict[str, Any]:
    result = summary(identified.model)
    result["findings"] = identified.findings + result["findings"]
    result["fit"] = {each.recording.name: _fits(each) for each in identified.fitted}
    result["held_out"] = {each.recording.name: _fits(each) for each in identified.held_out}
    result["verdict"] = verdict(identified.fitted)
    regression = identified.model.regression._asdict()
    result["regression"] = {n: value for n, value in regression.items() if n != "alpha_error"}
    return result


def _fits(prediction: Prediction) -> dict[str, float]:
    fits = {name.replace(" ", "_"): value for name, value in prediction.fits().items()}
    first = prediction.fits(FIRST_SECONDS)["pendulum angle"]
    return {**fits, "pendulum_angle_first_3_s": first}


def _write_rig(identified: Identified, file: Path, given: Rig | None, source: Path) -> list[str]:
    """Write the rig file; returns where its sensors come from."""
    from furuta_hw.rigs.rig_file import rig_file_text
    from furuta_identification.rigs.base_rig import base_rig
    from furuta_identification.rigs.identified_rig import identified_rig

    model = identified.model
    base, found = (given, []) if given is not None else base_rig(source, model.recordings[0])
    rig, uncertainty = identified_rig(model, base)
    comments = [
        "Identified from recordings; load with --rig.",
        *found,
        *(f"{name}: not determined: {why}" for name, why in undetermined(model).items()),
    ]
    file.write_text(rig_file_text(rig, uncertainty, file.stem, comments), encoding="utf-8")
    return found


def _print(result: dict[str, Any]) -> None:
    _print_values(result)
    for name, reason in result["undetermined"].items():
        print(f"{name:26} not determined by the data: {reason}")
    for kind in ("fit", "held_out"):
        for recording, fits in result[kind].items():
            known = {name: value for name, value in fits.items() if not np.isnan(value)}
            text = ", ".join(f"{n.replace('_', ' ')} {v:.1f} %" for n, v in known.items())
            print(f"{kind.replace('_', '-')} {recording}: {text}")
    for wave in result["waves"]:
        if wave["cos"] is not None and wave["sin"] is not None:
            size = np.hypot(wave["cos"], wave["sin"])
            print(f"torque wave, {wave['order']:2d} per turn {size:11.3g} V")
    _print_laws(result)
    _print_verdict(result["verdict"])
    for finding in result["findings"]:
        print(f"found: {finding}")
    for name in ("figure", "rig_file"):
        if name in result:
            print(f"{name.replace('_', ' ')}: {result[name]}")


def _print_laws(result: dict[str, Any]) -> None:
    for each in result.get("friction_laws", []):
        errors = ", ".join(f"{name} {error:.3f}" for name, error in each["errors"].items())
        law = f"{each['law']} ({each['parameters']} parameters)"
        print(f"law {law:31} held-out error over Coulomb's: {errors}")
    if "simplest_adequate_law" in result:
        print(f"law supported by the data: {result['simplest_adequate_law']}")


def _print_verdict(found: dict[str, Any]) -> None:
    for name, channels in found["coloured_percent"].items():
        known = {channel: part for channel, part in channels.items() if not np.isnan(part)}
        text = ", ".join(f"{n.replace('_', ' ')} {v:.0f} %" for n, v in known.items())
        print(f"coloured residuals (white: 5 %) {name}: {text}")
    print(f"usable: {found['usable']}" + "".join(f"; {each}" for each in found["reasons"]))


def _print_values(result: dict[str, Any]) -> None:
    errors = result["standard_errors"]
    for group in (result, result["lugre"], result["setup"]):
        for name, value in group.items():
            if isinstance(value, (float, np.floating)) and name in errors:
                error = errors[name]
                print(f"{name:26} {value:12.6g}" + (f"  ± {error:.2g}" if error else ""))
