"""A recorded session beside the same computed again."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

from furuta_analysis.simulation.recomputation import Recomputed
from furuta_model.state import PHI_DOT, THETA, THETA_DOT
from furuta_studies.recompute import RecordedLoop

SERIES = (
    ("arm speed [rad/s]", "estimate", PHI_DOT),
    ("pendulum θ [rad]", "estimate", THETA),
    ("pendulum speed [rad/s]", "estimate", THETA_DOT),
    ("friction estimate [V]", "friction_estimate", None),
    ("command [V]", "command", None),
)


def draw_difference(session: RecordedLoop, again: Recomputed, path: Path) -> None:
    """Each series recorded and computed again."""
    figure, axes = plt.subplots(
        len(SERIES), 1, sharex=True, figsize=(10, 2 * len(SERIES)), layout="constrained"
    )
    for axis, (label, name, channel) in zip(axes, SERIES, strict=True):
        old, new = getattr(session.recorded, name), getattr(again, name)
        if channel is not None:
            old, new = old[:, channel], new[:, channel]
        axis.plot(session.time, old, lw=1.4, label="recorded")
        axis.plot(session.time, new, lw=0.8, label="computed again")
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
        axis.margins(x=0)
    axes[0].legend(loc="upper right")
    axes[-1].set_xlabel("time [s]")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)
    plt.close(figure)
