"""A program that replays a simulated run through exported C and compares the commands."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from furuta.export.values import DOUBLE, Precision
from furuta_model.parts.pushes import Pushes
from furuta_sim.simulation.closed_loop import Loop, simulate

SAMPLES = 500
# A push on the pendulum that lets it fall: when and how long [s], relative to its weight.
PUSH_BEGIN, PUSH_TIME, PUSH_SIZE = 0.15, 0.1, 1.0
# Deviation of a float's command that counts as rounding, relative to the voltage limit.
FLOAT_TOLERANCE = 1e-3

_TEST = """\
/* Replays a simulated run with the sensors' noise and a push, and compares the commands.
 * Prints the largest deviation; the exit status is 1 if it is above the tolerance. */
#include <math.h>
#include <stdio.h>

#include "loop.h"

/* phi [rad], phi_dot [rad/s], theta [rad], theta_dot [rad/s], torque [V] */
static const {real} readings[{samples}][5] = {{
{readings}
}};

/* Command and friction estimate as the simulation computed them, in double [V]. */
static const double expected[{samples}][2] = {{
{expected}
}};

int main(void) {{
    const double tolerance = {tolerance};
    double largest = 0.0;
    loop_memory memory;
    loop_init(&memory);
    for (int k = 0; k < {samples}; k++) {{
        const {real} *r = readings[k];
        const loop_reading reading = {{r[0], r[1], r[2], r[3], r[4]}};
        loop_command command;
        loop_step(&memory, &reading, &command);
        largest = fmax(largest, fabs((double)command.voltage - expected[k][0]));
        largest = fmax(largest, fabs((double)command.friction - expected[k][1]));
    }}
    printf("largest deviation in {samples} samples: %g V\\n", largest);
    return largest > tolerance;
}}
"""


def test_program(loop: Loop, precision: Precision) -> str:
    """The program for a loop: the last bit must agree in double."""
    plant = loop.plant
    push = Pushes(
        times=(PUSH_BEGIN,), durations=(PUSH_TIME,), pendulum=(PUSH_SIZE * plant.model.delta,)
    )
    run = simulate(loop._replace(plant=plant._replace(pushes=push)), SAMPLES * plant.sample_time)
    return _TEST.format(
        real=precision.name,
        samples=SAMPLES,
        readings=_rows(run.measurement.tolist(), precision),
        expected=_rows(np.column_stack([run.command, run.friction_estimate]).tolist(), DOUBLE),
        tolerance=FLOAT_TOLERANCE * loop.controller.voltage_limit if precision.suffix else 0.0,
    )


def _rows(rows: Iterable[list[float]], precision: Precision) -> str:
    return "\n".join("    {" + ", ".join(map(precision.literal, row)) + "}," for row in rows)
