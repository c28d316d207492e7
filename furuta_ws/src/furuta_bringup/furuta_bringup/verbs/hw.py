"""``furuta hw``: commissioning of a rig, arming of the bridge, and the emulated rig."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypeVar

import click

from furuta_bringup.option_types import FiniteRange
from furuta_bringup.options import (
    HelpfulGroup,
    figure_option,
    joined_node,
    json_option,
    namespace_option,
    option,
    own_parts_option,
)
from furuta_bringup.printing import print_json, show, with_status
from furuta_hw.commissioning import RAMP_RATE
from furuta_hw.errors import RigError
from furuta_ros.errors import UserError
from furuta_ros.process import interrupt_raised
from furuta_ros.topics import TRANSITIONS

if TYPE_CHECKING:
    from furuta_bringup.graph.system_client import BridgeClient
    from furuta_hw.commissioning.session import RigSession
    from furuta_hw.connection.rig_driver import RigSample

Function = TypeVar("Function", bound=Callable[..., Any])

# Time between two lines of ``read`` [s].
DISPLAY_PERIOD = 0.1
# Time for which the pendulum must hang at rest before friction is measured [s].
REST_SECONDS = 1.0
# Numbers that the options take, in SI units.
SECONDS = FiniteRange(0.0, 3600.0, min_open=True)
VOLTAGES = FiniteRange(0.0, 1e3, min_open=True)
ANGLES = FiniteRange(0.01, 1e6)
RATES = FiniteRange(1e-3, 10.0)


@click.group(cls=HelpfulGroup)
def command() -> None:
    """Commission a rig, arm and disarm the bridge, emulate a rig.

    check, read, zero, signs and friction open the port themselves: end a bridge that uses it first.
    """


def rig_options(function: Function) -> Function:
    """``--port``, ``--rig`` and ``--own-parts``."""
    rig = option(
        "--rig", "name", default="paper", metavar="NAME|FILE", help="Rig, by name or file."
    )
    port = "Port of the rig, or mock for an emulated rig."
    return option("--port", required=True, metavar="PORT", help=port)(
        rig(own_parts_option(function))
    )


def drive_options(function: Function) -> Function:
    """``--voltage`` and ``--arm-range``, the limits of verbs that drive."""
    stop = "Stop when the arm is further than this from its start, in either direction [rad]."
    voltage = option("--voltage", type=VOLTAGES, default=2.0, help="Largest voltage [V].")
    return option("--arm-range", type=ANGLES, default=3.0, help=stop)(voltage(function))


@contextmanager
def _open_rig(port: str, name: str) -> Iterator[RigSession]:
    """Open the line to a rig; errors of the rig become one line."""
    from furuta_hw.commissioning.session import RigSession
    from furuta_hw.rigs.known_rigs import find_rig

    rig = find_rig(name)
    try:
        with interrupt_raised(), RigSession(port, rig) as session:
            yield session
    except RigError as error:
        raise UserError(str(error)) from None


@command.command()
@rig_options
@option("--seconds", type=SECONDS, default=3.0, help="Duration of the check.")
@json_option
def check(port: str, name: str, seconds: float, as_json: bool) -> None:
    """Check the serial line. Drives nothing.

    Measures the handshake and the sample rate, and counts lost and corrupt frames.
    """
    started = perf_counter()
    with with_status("checking", as_json), _open_rig(port, name) as session:
        handshake = perf_counter() - started
        started = perf_counter()
        samples = sum(1 for _ in session.samples(seconds))
        duration = perf_counter() - started
        line, rig = session.statistics(), session.rig
    result = {
        "handshake_seconds": handshake,
        "samples": samples,
        "samples_per_s": samples / duration,
        "expected_per_s": 1.0 / rig.line.sample_time,
    }
    frames = {name: count for name, count in line._asdict().items() if name != "discarded_by_rig"}
    show(result | frames, as_json)
    if line.bad > rig.limits.bad_frames * samples:
        raise UserError(f"{line.bad} of {samples} frames were lost or corrupt")


@command.command()
@rig_options
@option("--seconds", type=SECONDS, default=10.0, help="Duration of reading.")
@json_option
def read(port: str, name: str, seconds: float, as_json: bool) -> None:
    """Show live sensor values, as codes and in SI units. Drives nothing.

    With --json, print their mean and spread instead.
    """
    samples: list[RigSample] = []
    with _open_rig(port, name) as session:
        every = max(1, round(DISPLAY_PERIOD / session.rig.line.sample_time))
        for sample in session.samples(seconds):
            samples.append(sample)
            if not as_json and len(samples) % every == 0:
                print(f"\r{_sample_line(sample)}", end="\033[K", flush=True)
    if as_json:
        print_json(_summary(samples))
    else:
        print()


def _sample_line(sample: RigSample) -> str:
    codes = [f"{code:7d} = " for code in sample.codes] if sample.codes else [""] * 3
    return (
        f"arm {codes[0]}{sample.arm_angle:+8.4f} rad   "
        f"speed {codes[1]}{sample.arm_speed:+8.4f} rad/s   "
        f"pendulum {codes[2]}{sample.pendulum_angle:+8.4f} rad"
        + ("  AT THE END OF A RANGE" if sample.at_rail else "")
    )


def _summary(samples: list[RigSample]) -> dict[str, Any]:
    """Mean and spread of the codes, if the driver provides codes, and means in SI units."""
    import numpy as np

    from furuta_hw.commissioning.sensors import code_statistics

    codes = code_statistics(samples) if samples[-1].codes else {}
    angles = [(s.arm_angle, s.arm_speed, s.pendulum_angle) for s in samples]
    names = ("phi_rad", "phi_dot_rad_s", "theta_rad")
    means = dict(zip(names, map(float, np.mean(angles, axis=0)), strict=True))
    return codes | means | {"at_rail": samples[-1].at_rail}


@command.command()
@rig_options
@option("--seconds", type=SECONDS, default=2.0, help="Duration of averaging.")
@option("--hanging", is_flag=True, help="The pendulum hangs; its sensor must cover that angle.")
@json_option
def zero(port: str, name: str, seconds: float, hanging: bool, as_json: bool) -> None:
    """Measure the zeros of the sensors.

    Meanwhile hold the pendulum upright, or let it hang with --hanging, and the arm at rest.
    """
    from furuta_hw.commissioning.sensors import find_zeros

    with with_status("reading", as_json), _open_rig(port, name) as session:
        zeros = find_zeros(list(session.samples(seconds)), session.rig, hanging)
    show(zeros, as_json)


@command.command()
@rig_options
@drive_options
@json_option
def signs(port: str, name: str, voltage: float, arm_range: float, as_json: bool) -> None:
    """Determine the signs of the sensors by a small arm motion. DRIVES THE ARM, within limits."""
    from furuta_hw.commissioning.sensors import find_signs

    with with_status("driving the arm", as_json), _open_rig(port, name) as session:
        result = session.drive(find_signs(session.rig, voltage), voltage, arm_range)
    show({f"{sensor}.sign": sign for sensor, sign in result._asdict().items()}, as_json)


@command.command()
@rig_options
@drive_options
@option("--rate", type=RATES, default=RAMP_RATE, help="Rate of the voltage ramps [V/s].")
@option("--removed", is_flag=True, help="The pendulum is removed; do not check that it hangs.")
@figure_option("Draw the measured friction over speed.")
@json_option
def friction(
    port: str,
    name: str,
    voltage: float,
    arm_range: float,
    rate: float,
    removed: bool,
    figure: Path | None,
    as_json: bool,
) -> None:
    """Measure Coulomb, stiction and viscous friction. DRIVES THE ARM, within limits.

    The pendulum must hang at rest or be removed. This takes one to two minutes.
    """
    from furuta.results.rig_friction import MeasuredFriction
    from furuta_hw.commissioning.friction import check_arm_range, check_hanging, measure_friction

    with with_status("reading", as_json) as tell, _open_rig(port, name) as session:
        check_arm_range(session.rig, arm_range)
        if not removed:
            check_hanging(list(session.samples(REST_SECONDS)))
        experiment = measure_friction(session.rig, rate, tell, voltage)
        levels = session.drive(experiment, voltage, arm_range)
    show(MeasuredFriction(**vars(levels)), as_json, figure)


@contextmanager
def _bridge_client(namespace: str) -> Iterator[BridgeClient]:
    with with_status("asking the bridge"):
        from furuta_bringup.graph.system_client import BridgeClient

        with joined_node("furuta_hw", namespace) as joined:
            yield BridgeClient(*joined)


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
        now = client.state()
    print(now)


@command.command("rig")
@click.argument("name", metavar="NAME|FILE")
@json_option
def show_rig(name: str, as_json: bool) -> None:
    """Show the normalised model and the friction of a rig file."""
    from furuta_hw.rigs.known_rigs import find_rig
    from furuta_model.linear import linearize
    from furuta_model.parameters import declared

    rig = find_rig(name)
    a, b = linearize(rig.model)
    numbers = {"a23": a[1, 2], "a43": a[3, 2], "b21": b[1], "b41": b[3]}
    units = {"a23": "1/s²", "a43": "1/s²", "b21": "rad/(s² V)", "b41": "rad/(s² V)"}
    groups: tuple[Any, ...] = (rig.model, rig.friction, rig.line)
    for group in groups:
        units |= {each.name: each.about.unit for each in declared(group.__class__)}
    values = (
        rig.model._asdict()
        | {name: float(value) for name, value in numbers.items()}
        | rig.friction._asdict()
        | {"sample_time": rig.line.sample_time, "watchdog": rig.line.watchdog}
    )
    show(values | {"units": {name: units[name] for name in values}}, as_json)


@command.command(context_settings={"ignore_unknown_options": True, "help_option_names": []})
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def emulate(arguments: tuple[str, ...]) -> None:
    """Run an emulated rig; --help lists its options."""
    from furuta_bringup.graph.processes import executable

    path = executable("furuta_hw", "rig_emulator")
    os.execv(path, [str(path), *arguments])
