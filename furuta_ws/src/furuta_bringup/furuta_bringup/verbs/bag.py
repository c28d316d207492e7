"""``furuta bag``: info, export, recover, replay."""

from pathlib import Path
from typing import Any

import click

from furuta_bringup.option_types import PATH, SERIES, FiniteRange
from furuta_bringup.options import HelpfulGroup, figure_option, json_option, names_options, option
from furuta_bringup.printing import show, with_progress, with_status
from furuta_model.parameters import ParameterError
from furuta_recordings.readers import Mapping
from furuta_ros.time_stamps import NANOSECONDS

BAG = click.argument("bag", type=PATH)


@click.group(cls=HelpfulGroup)
def command() -> None:
    """Show, export, recover and replay recorded bags."""


@command.command()
@BAG
@json_option
def info(bag: Path, as_json: bool) -> None:
    """Show what BAG contains: topics, types, messages, times."""
    from furuta_recordings.bags.bag import Bag, parameter_file_of

    with Bag(bag) as content:
        result: dict[str, Any] = {
            "messages": content.message_count,
            "start_s": content.start / NANOSECONDS if content.message_count else None,
            "duration_s": content.seconds,
            "topics": {
                each.topic: {"type": each.msgtype, "messages": each.msgcount}
                for each in content.connections
            },
        }
    parameters = parameter_file_of(bag)
    result["parameters"] = str(parameters) if parameters else None
    show(result, as_json)


@command.command()
@click.argument("bag", type=PATH, metavar="BAG|FILE")
@option("--out", type=SERIES, metavar="FILE", help="Table to write (.csv, .parquet, .mat, .npz).")
@figure_option("Draw the series over time.")
@names_options
@json_option
def export(bag: Path, out: Path | None, figure: Path | None, names: Mapping, as_json: bool) -> None:
    """Write BAG as a table, one row per measurement, or draw it.

    FILE is a table of series instead, such as one of simulate --out. docs/topics.md lists the
    columns.
    """
    from furuta.recordings import series_with_findings

    if out is None and figure is None:
        raise click.UsageError("give --out FILE or --figure FILE")
    with with_status(f"reading {bag}", as_json) as tell:
        series, findings = series_with_findings(bag, names)
        if out is not None:
            tell(f"writing {out}")
            series.write(out)
    file = {"file": str(out)} if out is not None else {}
    about = {"rows": series.rows, "columns": list(series), "findings": findings}
    show(file | about, as_json, figure, drawn=series)


@command.command()
@BAG
@option("--out", type=PATH, metavar="BAG", help="New bag; default: BAG_recovered.")
@json_option
def recover(bag: Path, out: Path | None, as_json: bool) -> None:
    """Copy all complete messages of an MCAP bag into a new bag.

    BAG is not changed.
    """
    from furuta_recordings.bags.recovery import recover as recover_bag

    if not bag.exists():
        raise ParameterError(f"no bag {bag}")
    named = bag if bag.name else bag.resolve()  # the name of . is empty
    with with_status(f"recovering {bag}", as_json):
        result = recover_bag(bag, out or named.parent / f"{named.stem}_recovered")
    show(result, as_json)


def _remappings(
    ctx: click.Context, param: click.Parameter, values: tuple[str, ...]
) -> tuple[tuple[str, str], ...]:
    """Pairs of topics, from texts FROM:=TO."""
    pairs = [tuple(value.split(":=")) for value in values]
    for value, pair in zip(values, pairs, strict=True):
        if len(pair) != 2 or not all(pair):
            raise click.BadParameter(f"{value!r} is not FROM:=TO", ctx, param)
    return tuple((old, new) for old, new in pairs)


@command.command()
@BAG
@option(
    "--rate",
    type=FiniteRange(0.0, 1e6),
    default=1.0,
    help="Speed relative to the recording; 0: as fast as possible.",
)
@option("--topic", "topics", multiple=True, help="Replay only this topic; repeatable.")
@option(
    "--remap",
    multiple=True,
    callback=_remappings,
    metavar="FROM:=TO",
    help="Publish a topic under another name; repeatable.",
)
@option("--clock", is_flag=True, help="Publish the bag's time on /clock.")
@option("--wait", is_flag=True, help="Wait until every topic has a subscriber.")
@json_option
def replay(
    bag: Path,
    rate: float,
    topics: tuple[str, ...],
    remap: tuple[tuple[str, str], ...],
    clock: bool,
    wait: bool,
    as_json: bool,
) -> None:
    """Publish the messages of BAG with their original timing."""
    from furuta_recordings.replay_node import PARTS, ReplayNode, ReplayOptions
    from furuta_ros.process import StopSignal, bounded_end
    from furuta_ros.spinning import ros_context

    with ros_context():
        node = ReplayNode(bag, ReplayOptions(rate, topics, remap, clock, wait))
        for _ in with_progress("replaying", node.play(StopSignal()), PARTS, as_json):
            pass
        show({"published": node.published, "latest_s": node.latest}, as_json)
        with bounded_end(0):
            node.destroy_node()
