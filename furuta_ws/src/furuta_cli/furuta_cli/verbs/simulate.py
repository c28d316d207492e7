"""``furuta simulate``."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import Any

import click
import numpy as np

from furuta_analysis.simulation.closed_loop import Simulation
from furuta_analysis.simulation.oscillation import fell, measure_oscillation
from furuta_cli.file_types import SERIES_OR_FIGURE
from furuta_cli.options import (
    SEED,
    SIMULATED_SECONDS,
    feedback_option,
    json_option,
    model_options,
    print_json,
)
from furuta_graph.settings import load_settings, loop
from furuta_model.state import LARGEST_VALUE


@click.command(context_settings={"ignore_unknown_options": False})
@click.option(
    "--seconds", type=SIMULATED_SECONDS, default=60.0, show_default=True, help="Simulated time [s]."
)
@click.option(
    "--compensation",
    metavar="NAME",
    help="Friction compensation; default: as set by the parameters.",
)
@click.option(
    "--ideal-sensors",
    is_flag=True,
    help="Measure all four states exactly; the arm may turn without limit.",
)
@feedback_option
@click.option("--seed", type=SEED, help="Seed of the sensors' noise.")
@click.option(
    "--out",
    type=SERIES_OR_FIGURE,
    metavar="FILE.npz|FILE.png",
    help="Write the time series, or draw them.",
)
@model_options
@json_option
def command(
    seconds: float,
    compensation: str | None,
    ideal_sensors: bool,
    feedback: tuple[float, float, float, float] | None,
    seed: int | None,
    out: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Simulate the closed loop without ROS and measure the oscillation in the second half."""
    first, extra = [], []
    if compensation is not None:
        extra.append(f"friction_observer.compensation={compensation}")
    if ideal_sensors:
        extra.append("sensors.ideal=true")
        # The motion of the ideal loop may be a rotation, and its feedback is linear.
        limits = ("angle", "error", "speed")
        first += [f"controller.arm_{each}_limit={LARGEST_VALUE}" for each in limits]
    if seed is not None:
        extra.append(f"plant.seed={seed}")
    if feedback is not None:
        extra.append(f"controller.gain={[-each for each in feedback]}")
    settings = load_settings(files, [*first, *assignments, *extra])
    simulation = Simulation(loop(settings))
    began = perf_counter()
    record = simulation.run(seconds)
    wall = perf_counter() - began
    if simulation.switched_off:
        click.echo(f"note: {simulation.loop.observer.switch_off_reason}", err=True)
    result = _result(record, wall)
    if out is not None:
        _save(record, out, simulation.loop.plant.actuator)
    if as_json:
        print_json(result)
    else:
        for name, value in result.items():
            print(f"{name:24} {value}")


def _result(record: Any, wall_seconds: float) -> dict[str, Any]:
    settled = record.state[len(record.command) // 2 :]
    return {
        **measure_oscillation(settled, record.sample_time)._asdict(),
        "fell": fell(record.state),
        "steps": len(record.command),
        "wall_seconds": wall_seconds,
    }


def _save(record: Any, out: Path, actuator: Any) -> None:
    if out.suffix != ".npz":
        from furuta_figures.run import draw_run

        draw_run(record, out)
        return
    fields = {name: value for name, value in record._asdict().items() if name != "sample_time"}
    np.savez_compressed(out, time=record.time, drive=np.array(actuator), **fields)
