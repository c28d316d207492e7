"""``furuta simulate``."""

import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import click

from furuta_bringup.option_types import SERIES_OR_FIGURE
from furuta_bringup.options import (
    SEED,
    SIMULATED_SECONDS,
    feedback_option,
    json_option,
    law_option,
    model_options,
    option,
)
from furuta_bringup.printing import show, with_progress, with_status
from furuta_recordings.suffixes import SUFFIXES
from furuta_ros.whole_files import whole_file


@click.command()
@option("--seconds", type=SIMULATED_SECONDS, default=60.0, help="Simulated time [s].")
@option(
    "--compensation",
    metavar="NAME",
    help="Friction compensation; default: as set by the parameters.",
)
@option(
    "--ideal-sensors",
    is_flag=True,
    help="Measure all four states exactly; the arm may turn without limit.",
)
@law_option
@feedback_option
@option("--seed", type=SEED, help="Seed of the sensors' noise.")
@option(
    "--out",
    type=SERIES_OR_FIGURE,
    metavar="FILE",
    help="Write the time series (.npz, .csv, .mat, .parquet), or draw them (.png, .pdf, .svg).",
)
@model_options
@json_option
def command(
    seconds: float,
    compensation: str | None,
    ideal_sensors: bool,
    law: str | None,
    feedback: tuple[float, float, float, float] | None,
    seed: int | None,
    out: Path | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Simulate the closed loop without ROS and measure the oscillation in the second half."""
    from furuta.settings.settings import (
        law_and_feedback,
        load_settings,
        loop,
        require_agreement,
    )
    from furuta_model.state import LARGEST_VALUE
    from furuta_sim.simulation.closed_loop import Simulation

    first, options = [], law_and_feedback(law, feedback)
    if compensation is not None:
        options["--compensation"] = f"friction_observer.compensation={compensation}"
    if ideal_sensors:
        options["--ideal-sensors"] = "sensors.ideal=true"
        # The motion of the ideal loop may be a rotation, and its feedback is linear.
        limits = ("angle", "error", "speed")
        first = [f"controller.arm_{limit}_limit={LARGEST_VALUE}" for limit in limits]
    if seed is not None:
        options["--seed"] = f"plant.seed={seed}"
    require_agreement(assignments, options)
    with with_status("loading", as_json):
        settings = load_settings(files, [*first, *assignments, *options.values()])
        simulation = Simulation(loop(settings))
    began = perf_counter()
    record = simulation.run(
        seconds, lambda blocks: with_progress("simulating", blocks, len(blocks), as_json)
    )
    wall = perf_counter() - began
    result = _result(record, wall)
    if out is not None:
        _save(record, out, simulation.loop.plant.actuator)
    if result["fell"] and not as_json:
        print(_note_on_fall(record, simulation.loop), file=sys.stderr)
    show(result, as_json)


def _note_on_fall(record: Any, loop: Any) -> str:
    """That the figures mean nothing, and why the pendulum fell if that is evident."""
    from furuta.oscillation import has_fallen

    friction, limit = loop.plant.friction.parameters.alpha0, loop.controller.voltage_limit
    why = f"; alpha0, {friction:g} V, exceeds the drive's {limit:g} V" if friction > limit else ""
    fall = record.time[has_fallen(record.state).argmax()]
    return f"note: the pendulum fell after {fall:.3g} s, so the figures mean nothing{why}"


def _result(record: Any, wall_seconds: float) -> dict[str, Any]:
    from furuta.oscillation import fell, measure_oscillation

    settled = record.state[len(record.command) // 2 :]
    return {
        **measure_oscillation(settled, record.sample_time)._asdict(),
        "fell": fell(record.state),
        "steps": len(record.command),
        "wall_seconds": wall_seconds,
    }


def _save(record: Any, out: Path, actuator: Any) -> None:
    suffix = out.suffix.lower()
    if suffix == ".npz":
        import numpy as np

        from furuta_recordings.table_files import write_npz

        fields = {name: value for name, value in record._asdict().items() if name != "sample_time"}
        with whole_file(out) as new:
            write_npz(new, {"time": record.time, "drive": np.array(actuator), **fields})
        return
    from furuta.recordings import simulated_series

    series = simulated_series(record)
    if suffix in SUFFIXES:
        from furuta_recordings.table_files import write_columns

        write_columns(out, series)
    else:
        from furuta.figures.series import draw_series

        draw_series(series, out)
