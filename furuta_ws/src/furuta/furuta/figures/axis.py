"""A hunting axis: its exact cycle, and what remains with the recommended compensation."""

from pathlib import Path

import numpy as np

from furuta.axis.simulation import AxisRecord
from furuta.figures.figure import (
    ARM,
    CONTROL,
    ESTIMATE,
    FRICTION,
    REFERENCE,
    saved_figure,
    style_axis,
)
from furuta.limit_cycles.joint import JointCycle
from furuta.limit_cycles.periodic_orbit import Trajectory
from furuta_model.state import PHI, PHI_DOT

# Periods of the cycle that are drawn.
PERIODS = 2


def draw_axis(
    motion: Trajectory | None,
    cycle: JointCycle,
    runs: dict[str, AxisRecord],
    path: Path,
) -> None:
    """Draw the exact cycle (its ``motion`` in time and in the phase plane) and simulated ``runs``.

    The second half of each of the ``runs`` is drawn, which are given by compensation.
    """
    with saved_figure(path, 2, 2, figsize=(10, 6.5)) as (figure, axes):
        (position, after), (force, plane) = axes
        if motion is not None:
            centre = 0.5 * (np.min(motion.state[:, PHI]) + np.max(motion.state[:, PHI]))
            time = np.concatenate([motion.time + k * cycle.period_s for k in range(PERIODS)])
            angle = np.tile(motion.state[:, PHI] - centre, PERIODS)
            position.plot(time, angle, color=ARM)
            force.plot(time, np.tile(motion.control, PERIODS), color=CONTROL, label="drive")
            force.plot(time, np.tile(motion.friction, PERIODS), color=FRICTION, label="friction")
            force.legend()
            plane.plot(motion.state[:, PHI] - centre, motion.state[:, PHI_DOT], color=ARM)
        for (name, run), colour in zip(runs.items(), (REFERENCE, ESTIMATE), strict=False):
            settled = slice(len(run.time) // 2, None)
            time, error = run.time[settled] - run.time[settled.start], run.error[settled]
            after.plot(time, error, color=colour, label=f"compensation {name}")
        if runs:
            after.margins(y=0.3)
            after.legend()
        style_axis(position, y="exact: position [rad]")
        style_axis(force, "time [s]", "torque [N m]")
        style_axis(plane, "position [rad]", "speed [rad/s]")
        style_axis(after, "time [s]", "simulated: error [rad]")
        figure.suptitle(_title(cycle))


def _title(cycle: JointCycle) -> str:
    if cycle.kind != "limit_cycle":
        return f"final motion: {cycle.kind}"
    return (
        f"limit cycle: {cycle.peak_to_peak:.4g} rad peak to peak, period {cycle.period_s:.3g} s, "
        f"stuck {cycle.stuck_fraction:.0%}, {'stable' if cycle.stable else 'unstable'}"
    )
