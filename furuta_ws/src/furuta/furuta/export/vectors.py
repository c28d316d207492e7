"""A program that replays a simulated run through exported C and compares the commands."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from furuta.export.text import filled
from furuta.export.values import DOUBLE, Precision
from furuta_model.parts.disturbances import Pushes
from furuta_model.parts.sensor_faults import SensorFaults
from furuta_model.sensors import measure
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import Noise
from furuta_sim.simulation.closed_loop import Loop, Record, simulate

SAMPLES = 500
# A push on the pendulum that lets it fall: when and how long [s], relative to its weight.
PUSH_BEGIN, PUSH_TIME, PUSH_SIZE = 0.15, 0.1, 1.0
# Deviation of a float's command that counts as rounding, relative to the voltage limit.
FLOAT_TOLERANCE = 1e-3


def test_program(loop: Loop, precision: Precision) -> str:
    """The program for a loop: the last bit must agree in double."""
    size = PUSH_SIZE * loop.plant.model.delta
    push = Pushes(times=(PUSH_BEGIN,), durations=(PUSH_TIME,), pendulum=(size,))
    plant = loop.plant._replace(pushes=push, sensor_faults=SensorFaults())
    run = simulate(loop._replace(plant=plant), SAMPLES * plant.sample_time)
    return filled(
        "loop_test.c",
        real=precision.name,
        samples=SAMPLES,
        readings=_rows(_readings(run, plant).tolist(), precision),
        expected=_rows(np.column_stack([run.command, run.friction_estimate]).tolist(), DOUBLE),
        tolerance=FLOAT_TOLERANCE * loop.controller.voltage_limit if precision.suffix else 0.0,
    )


def _readings(run: Record, plant: PlantParameters) -> np.ndarray:
    """What the sensors said (n, 5); the record has what the estimator made of it."""
    readings = run.measurement.copy()
    noise = Noise(plant.seed)
    for state, reading in zip(run.state, readings, strict=True):
        measure(state, noise(), plant.sensors, reading)
    return readings


def _rows(rows: Iterable[list[float]], precision: Precision) -> str:
    return "\n".join("    {" + ", ".join(map(precision.literal, row)) + "}," for row in rows)
