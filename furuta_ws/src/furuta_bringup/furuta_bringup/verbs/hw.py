"""``furuta hw``: commissioning of a rig, arming of the bridge, and the emulated rig."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from furuta_bringup.groups import HelpfulGroup
from furuta_bringup.options import json_option, namespace_option
from furuta_bringup.printing import show
from furuta_bringup.verbs.hw_commissioning import check, friction, read, signs, zero
from furuta_graph.transitions import TRANSITIONS

if TYPE_CHECKING:
    from furuta_graph.system_client import BridgeClient


@click.group(cls=HelpfulGroup)
def command() -> None:
    """Commission a rig, arm and disarm the bridge, emulate a rig.

    check, read, zero, signs and friction open the port themselves: end a bridge that uses it first.
    """


for verb in (check, read, zero, signs, friction):
    command.add_command(verb)


@contextmanager
def _bridge_client(namespace: str) -> Iterator[BridgeClient]:
    from rclpy.node import Node

    from furuta_graph.system_client import BridgeClient
    from furuta_ros.context import joined_graph
    from furuta_ros.spinning import executor_of

    with joined_graph(namespace):
        node = Node("furuta_hw", start_parameter_services=False)
        yield BridgeClient(node, executor_of([node]))


@command.command()
@namespace_option
def arm(namespace: str) -> None:
    """Arm the bridge: commands drive the rig from now on.

    If the bridge refuses, or stops the rig within a second, the reason is printed and the exit
    status is 1.
    """
    with _bridge_client(namespace) as client:
        client.arm_and_watch()
        print("armed")


@command.command()
@namespace_option
def disarm(namespace: str) -> None:
    """Disarm the bridge: the rig goes to 0 V."""
    with _bridge_client(namespace) as client:
        client.disarm()
        print("disarmed, 0 V")


@command.command()
@click.argument("transition", required=False, type=click.Choice(list(TRANSITIONS)))
@namespace_option
def state(transition: str | None, namespace: str) -> None:
    """Print the state of the bridge; TRANSITION changes it first."""
    with _bridge_client(namespace) as client:
        if transition:
            client.change_state(transition)
        print(client.state())


@command.command("rig")
@click.argument("name", metavar="NAME|FILE")
@json_option
def show_rig(name: str, as_json: bool) -> None:
    """Show the normalised model and the friction of a rig file."""
    from furuta_hw.rigs.known_rigs import find_rig
    from furuta_model.linear import linearize

    rig = find_rig(name)
    a, b = linearize(rig.model)
    numbers = {"a23": a[1, 2], "a43": a[3, 2], "b21": b[1], "b41": b[3]}
    show(
        rig.model._asdict()
        | {name: float(value) for name, value in numbers.items()}
        | rig.friction._asdict()
        | {"sample_time": rig.line.sample_time, "watchdog": rig.line.watchdog},
        as_json,
    )


@command.command(context_settings={"ignore_unknown_options": True, "help_option_names": []})
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def emulate(arguments: tuple[str, ...]) -> None:
    """Run an emulated rig on a pseudo-terminal; --help lists its options."""
    from furuta_graph.processes import executable

    path = executable("furuta_hw", "rig_emulator")
    os.execv(path, [str(path), *arguments])
