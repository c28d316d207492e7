"""``furuta bag``: info, recover, replay, recompute."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from furuta_cli.options import FiniteRange, json_option, model_options, print_json
from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.recovery import recover as recover_bag
from furuta_recordings.recorder_node import PARAMETERS_FILE
from furuta_recordings.replay_node import ReplayNode, ReplayOptions
from furuta_ros.context import ros_context
from furuta_ros.messages import NANOSECONDS
from furuta_ros.spinning import StopSignal
from furuta_studies.recompute import compare, recomputed

BAG = click.argument("bag", type=click.Path(path_type=Path))


@click.group()
def command() -> None:
    """Recorded bags: info, recover, replay, recompute."""


@command.command()
@BAG
@json_option
def info(bag: Path, as_json: bool) -> None:
    """Print the contents of BAG: topics, types, messages, time."""
    with Bag(bag) as reader:
        result: dict[str, Any] = {
            "messages": reader.message_count,
            "start_s": reader.start / NANOSECONDS if reader.message_count else None,
            "duration_s": reader.seconds if reader.message_count else 0.0,
            "topics": {
                c.topic: {"type": c.msgtype, "messages": c.msgcount} for c in reader.connections
            },
            "parameters": str(bag / PARAMETERS_FILE) if (bag / PARAMETERS_FILE).is_file() else None,
        }
    if as_json:
        print_json(result)
        return
    print(f"{result['messages']} messages, {result['duration_s']:.3f} s")
    for topic, about in result["topics"].items():
        print(f"{topic:24} {about['type']:32} {about['messages']}")
    if result["parameters"]:
        print(f"parameters: {result['parameters']}")


@command.command()
@BAG
@click.option("--out", type=click.Path(path_type=Path), help="New bag (default: BAG_recovered).")
@json_option
def recover(bag: Path, out: Path | None, as_json: bool) -> None:
    """Copy the readable part of BAG into a new bag; BAG itself is not changed."""
    if not bag.exists():
        raise ParameterError(f"no bag {bag}")
    result: dict[str, Any] = recover_bag(bag, out or bag.with_name(f"{bag.stem}_recovered"))
    if as_json:
        print_json(result)
        return
    print(f"{result['messages']} messages in {result['bag']}")
    for problem in result["problems"]:
        print(f"problem: {problem}")


@command.command()
@BAG
@click.option(
    "--rate",
    type=FiniteRange(0, 1e6),
    default=1.0,
    show_default=True,
    help="Speed; 0: as fast as possible.",
)
@click.option("--topic", "topics", multiple=True, help="Only this topic; repeatable.")
@click.option("--remap", multiple=True, metavar="FROM:=TO", help="Rename a topic; repeatable.")
@click.option("--clock", is_flag=True, help="Publish the bag's time on /clock.")
@click.option("--wait", is_flag=True, help="Wait until every topic has a subscriber.")
@json_option
def replay(
    bag: Path,
    rate: float,
    topics: tuple[str, ...],
    remap: tuple[str, ...],
    clock: bool,
    wait: bool,
    as_json: bool,
) -> None:
    """Publish the messages of BAG with their recorded timing."""
    pairs = [tuple(each.split(":=")) for each in remap]
    if any(len(pair) != 2 or not all(pair) for pair in pairs):
        raise ParameterError(f"--remap must be FROM:=TO, given {', '.join(remap)}")
    with ros_context():
        names = tuple((a, b) for a, b in pairs)
        node = ReplayNode(bag, ReplayOptions(rate, topics, names, clock, wait))
        node.play(StopSignal())
        result = {"published": node.published, "latest_s": node.latest}
        node.destroy_node()
    if as_json:
        print_json(result)
    else:
        print(f"{node.published} messages, at most {node.latest * 1e3:.1f} ms late")


@command.command()
@BAG
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE.png", help="Draw both.")
@model_options
@json_option
def recompute(
    bag: Path,
    out: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Run estimator, observer and controller again on the measurements of BAG, and compare.

    With the parameters recorded in it, or with others: what would this tuning have commanded?
    The measurements remain as recorded: the pendulum does not react to the new commands.
    """
    session, again = recomputed(bag, files, assignments)
    result = compare(session, again)
    if out is not None:
        from furuta_figures.difference import draw_difference

        draw_difference(session, again, out)
        result["figure"] = str(out)
    if as_json:
        print_json(result)
        return
    print(f"{result['samples']} samples, " + ("identical" if result["identical"] else "different"))
    for name in ("estimate", "friction_estimate", "command"):
        each = result[name]
        print(
            f"{name:18} largest difference {each['largest_difference']:.6g}, "
            f"rms {each['rms_difference']:.6g} over {each['compared']}"
        )
