"""A recorded session and its recomputation."""

from __future__ import annotations

from pathlib import Path

from furuta.figures.figure import saved_figure, style_time_series
from furuta.studies.recorded_loop import RecordedLoop
from furuta_model.state import PHI_DOT, THETA, THETA_DOT
from furuta_sim.simulation.recomputation import Recomputed

# Label, field of Recomputed, column.
SERIES = (
    ("arm speed [rad/s]", "estimate", PHI_DOT),
    ("pendulum θ [rad]", "estimate", THETA),
    ("pendulum speed [rad/s]", "estimate", THETA_DOT),
    ("friction estimate [V]", "friction_estimate", None),
    ("command [V]", "command", None),
)


def draw_recomputation(recorded: RecordedLoop, recomputed: Recomputed, path: Path) -> None:
    """Draw each series as recorded and as recomputed."""
    size = (10, 2 * len(SERIES))
    with saved_figure(path, len(SERIES), sharex=True, figsize=size, dpi=100) as (_, axes):
        for axis, (label, name, column) in zip(axes, SERIES, strict=True):
            old, new = getattr(recorded.outputs, name), getattr(recomputed, name)
            if column is not None:
                old, new = old[:, column], new[:, column]
            axis.plot(recorded.time, old, lw=1.4, label="recorded")
            axis.plot(recorded.time, new, lw=0.8, label="computed again")
            style_time_series(axis, label)
        axes[0].legend(loc="upper right")
        axes[-1].set_xlabel("time [s]")
