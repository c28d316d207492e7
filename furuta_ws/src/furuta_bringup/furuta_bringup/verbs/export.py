"""``furuta export``."""

from pathlib import Path
from typing import Any

import click

from furuta_bringup.options import HelpfulGroup, json_option, model_options
from furuta_bringup.printing import show
from furuta_ros.whole_files import whole_file


@click.group(cls=HelpfulGroup)
def command() -> None:
    """Export estimator, friction observer and controller for use without Python."""


@command.command("c")
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    required=True,
    help="Folder for loop.h, loop.c and loop_test.c.",
)
@click.option("--float", "single", is_flag=True, help="Numbers of 32 bits instead of 64.")
@model_options
@json_option
def c(
    out: Path, single: bool, files: tuple[Path, ...], assignments: tuple[str, ...], as_json: bool
) -> None:
    """Write estimator, friction observer and controller as C99.

    The code is translated from the functions that the nodes run. With numbers of 64 bits the
    commands are the same to the last bit. loop_test.c replays a simulated run and compares them.
    """
    from furuta.export.loop_files import loop_files
    from furuta.export.values import DOUBLE, FLOAT
    from furuta.settings.settings import load_settings, loop
    from furuta_hw.rigs.rig import Rig
    from furuta_hw.rigs.rig_file import is_rig_file, rig_from_content
    from furuta_ros.yaml_files import read_yaml

    exported = loop(load_settings(files, assignments))
    given, rig = {file: read_yaml(file, "parameter file") for file in files}, Rig()
    for file in filter(lambda file: is_rig_file(given[file]), files):
        rig, _ = rig_from_content(given[file], file)
    origin = ["Control system of the Furuta pendulum.", *map(_origin, given.items()), *assignments]
    contents = loop_files(exported, rig, FLOAT if single else DOUBLE, " ".join(origin))
    for name, content in contents.items():
        with whole_file(out / name) as path:
            path.write_text(content, encoding="utf-8")
    written = [out / name for name in contents]
    total = sum(path.stat().st_size for path in written)
    show({"files": list(map(str, written)), "bytes": total}, as_json)


def _origin(given: tuple[Path, Any]) -> str:
    """A parameter file, with the name of a rig and the sources of its values."""
    file, content = given
    sources = "; ".join(content.get("sources", []))
    return (
        f"{file.name}: {content.get('name', '')}, from {sources}." if sources else f"{file.name}."
    )
