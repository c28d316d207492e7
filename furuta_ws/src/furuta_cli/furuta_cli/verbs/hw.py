"""``furuta hw``: a real rig, from the first byte to its friction; and one in software."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any, TypeVar

import click
import numpy as np

from furuta_cli.options import json_option, print_json
from furuta_cli.verbs.hw_bridge import arm, disarm, state
from furuta_graph.processes import executable
from furuta_graph.rigs import find_rig, rig_settings
from furuta_hw.commissioning import RATE, measure_friction, signs, statistics, zeros
from furuta_hw.errors import RigError
from furuta_hw.rig import Rig
from furuta_hw.sensing import Sensing
from furuta_hw.session import Session
from furuta_model.linear import linearize
from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError

Function = TypeVar("Function", bound=Callable[..., Any])

# Time between two lines of ``read`` [s].
LINE = 0.1


@click.group()
def command() -> None:
    """Check the line to a rig, read it, find zeros, signs and friction, arm the bridge.

    All but arm, disarm and state open the port themselves, so no bridge may hold it.
    """


for each in (arm, disarm, state):
    command.add_command(each)


def rig_options(function: Function) -> Function:
    """``--port`` and ``--rig``."""
    function = click.option(
        "--rig", "name", default="paper", show_default=True, metavar="NAME|FILE", help="The rig."
    )(function)
    return click.option(
        "--port", required=True, metavar="PORT", help="Serial port, or mock for a rig in software."
    )(function)


def drive_options(function: Function) -> Function:
    """``--voltage`` and ``--travel``: the guard of verbs that drive."""
    function = click.option(
        "--voltage", default=2.0, show_default=True, help="Largest voltage [V]."
    )(function)
    return click.option(
        "--travel", default=3.0, show_default=True, help="Stop beyond ± this from here [rad]."
    )(function)


@contextmanager
def _session(port: str, rig: Rig) -> Iterator[Session]:
    try:
        with Session(port, rig) as session:
            yield session
    except RigError as error:
        raise UserError(str(error)) from None


def _seconds(seconds: float) -> float:
    if not 0 < seconds <= 3600:
        raise ParameterError(f"--seconds must be above 0 and at most 3600, given {seconds:g}")
    return seconds


def _show(result: dict[str, Any], as_json: bool) -> None:
    if as_json:
        print_json(result)
        return
    for name, value in result.items():
        print(f"{name:28} {value:.6g}" if isinstance(value, float) else f"{name:28} {value}")


@command.command()
@rig_options
@click.option("--seconds", default=3.0, show_default=True, help="How long to listen.")
@json_option
def check(port: str, name: str, seconds: float, as_json: bool) -> None:
    """Check the line: handshake, rate of samples, frames lost and corrupt. Drives nothing."""
    rig = find_rig(name)
    began = perf_counter()
    with _session(port, rig) as session:
        handshake = perf_counter() - began
        began = perf_counter()
        samples = sum(1 for _ in session.samples(_seconds(seconds)))
        took = perf_counter() - began
        host = session.host
        result = {
            "handshake_seconds": handshake,
            "samples": samples,
            "samples_per_s": samples / took,
            "expected_per_s": 1.0 / rig.line.sample_time,
            "lost": host.lost,
            "corrupt": host.corrupt,
            "repeated": host.repeated,
            "other_sessions": host.foreign,
        }
    _show(result, as_json)
    if host.bad > rig.limits.bad_frames * samples:
        raise UserError(f"{host.bad} of {samples} frames were lost or corrupt")


@command.command()
@rig_options
@click.option("--seconds", default=10.0, show_default=True, help="How long to read.")
@json_option
def read(port: str, name: str, seconds: float, as_json: bool) -> None:
    """Read the sensors live, codes and SI; with --json their mean and spread. Drives nothing."""
    rig = find_rig(name)
    sensing, kept, states = Sensing(rig), [], []
    every = max(1, round(LINE / rig.line.sample_time))
    with _session(port, rig) as session:
        for sensors in session.samples(_seconds(seconds)):
            x = sensing.take(sensors)
            kept.append(sensors)
            states.append(x[:3].copy())
            if not as_json and len(kept) % every == 0:
                rail = "  AT THE END OF A RANGE" if sensing.at_rail else ""
                print(
                    f"\rarm {sensors.arm:7d} = {x[0]:+8.4f} rad   speed {sensors.speed:6d} = "
                    f"{x[1]:+8.4f} rad/s   pendulum {sensors.pendulum:7d} = {x[2]:+8.4f} rad{rail}",
                    end="\033[K",
                    flush=True,
                )
    if not as_json:
        print()
        return
    names = ("phi_rad", "phi_dot_rad_s", "theta_rad")
    means = dict(zip(names, map(float, np.mean(states, axis=0)), strict=True))
    print_json(statistics(kept)._asdict() | means | {"at_rail": sensing.at_rail})


@command.command()
@rig_options
@click.option("--seconds", default=2.0, show_default=True, help="How long to average.")
@click.option("--hanging", is_flag=True, help="The pendulum hangs (its sensor must see that).")
@json_option
def zero(port: str, name: str, seconds: float, hanging: bool, as_json: bool) -> None:
    """Find the zeros with the pendulum held upright (or hanging) and all at rest."""
    rig = find_rig(name)
    with _session(port, rig) as session:
        samples = list(session.samples(_seconds(seconds)))
        try:
            found = zeros(samples, rig, hanging)
        except RigError as error:
            raise UserError(str(error)) from None
    _show(found, as_json)


@command.command("signs")
@rig_options
@drive_options
@json_option
def signs_(port: str, name: str, voltage: float, travel: float, as_json: bool) -> None:
    """Nudge the arm and find the signs of the sensors. DRIVES THE ARM, under the guard."""
    rig = find_rig(name)
    with _session(port, rig) as session:
        found = session.drive(signs(rig, voltage), voltage, travel)
    _show({f"{name}.sign": value for name, value in found._asdict().items()}, as_json)


@command.command()
@rig_options
@drive_options
@click.option("--rate", default=RATE, show_default=True, help="Of the ramps [V/s].")
@json_option
def friction(
    port: str, name: str, voltage: float, travel: float, rate: float, as_json: bool
) -> None:
    """Measure Coulomb, stiction and viscous friction. DRIVES THE ARM, under the guard.

    The pendulum hangs, or is taken off. Takes a minute or two.
    """
    rig = find_rig(name)
    if not 1e-3 <= rate <= 10:
        raise ParameterError(f"--rate must be 0.001 to 10 V/s, given {rate:g}")
    with _session(port, rig) as session:
        levels = session.drive(measure_friction(rig, travel, rate), voltage, travel)
    derived = {name: getattr(levels, name) for name in ("alpha0", "alpha1", "asymmetry")}
    _show(levels._asdict() | derived, as_json)


@command.command("rig")
@click.argument("name", metavar="NAME|FILE")
@click.option("--params", "as_file", is_flag=True, help="As a parameter file for --params.")
@json_option
def rig_(name: str, as_file: bool, as_json: bool) -> None:
    """Show what a rig file comes to: the normalised model and its friction."""
    rig = find_rig(name)
    if as_file:
        print(_parameter_file(rig), end="")
        return
    a, b = linearize(rig.model)
    numbers = {"a23": a[1, 2], "a43": a[3, 2], "b21": b[1], "b41": b[3]}
    _show(
        rig.model._asdict()
        | {name: float(value) for name, value in numbers.items()}
        | rig.friction._asdict()
        | {"sample_time": rig.line.sample_time, "watchdog": rig.line.watchdog},
        as_json,
    )


def _parameter_file(rig: Rig) -> str:
    import yaml

    nodes = {node: {"ros__parameters": given} for node, given in rig_settings(rig).items() if given}
    return str(yaml.safe_dump(nodes, sort_keys=False))


@command.command(context_settings={"ignore_unknown_options": True, "help_option_names": []})
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def emulate(arguments: tuple[str, ...]) -> None:
    """Run a rig in software on a pseudo-terminal (rig_emulator; see its --help)."""
    path = executable("furuta_hw", "rig_emulator")
    os.execv(path, [str(path), *arguments])
