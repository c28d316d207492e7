"""Figure of swing-ups: the pendulum's angle, times until upright, and the arm within its limits."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from furuta.figures.figure import ARM, PENDULUM, axes_for, style_axis
from furuta.studies.swing_up import DEADLINE, RUN_TIME, SwingUpRun


def draw_swing_up(runs: Sequence[SwingUpRun], axes: Any = None) -> Any:
    """Draw all starts; of the first ones also the pendulum's angle from upright over time."""
    _, axes = axes_for(axes, 1, 3, figsize=(14, 4.2))
    angle, upright, arm = axes
    shown = [run.theta for run in runs if len(run.theta)]
    for theta in shown:
        time = np.linspace(0.0, RUN_TIME, len(theta), endpoint=False)
        from_upright = np.degrees(np.abs(np.angle(np.exp(1j * theta))))
        angle.plot(time, from_upright, lw=0.7, alpha=0.4, color=PENDULUM)
    angle.set_xlim(0.0, RUN_TIME)
    angle.set_yticks(range(0, 181, 45))
    style_axis(angle, "time [s]", "pendulum from upright [°]")
    angle.set_title(f"the first {len(shown)} of {len(runs)} starts")
    times = sorted(run.upright_s for run in runs if np.isfinite(run.upright_s))
    fraction = np.arange(len(times) + 1) / len(runs)
    upright.step([0.0, *times, RUN_TIME], [*fraction, fraction[-1]], where="post", color=PENDULUM)
    upright.axvline(DEADLINE, color="0.3", ls="--", lw=1, label="deadline")
    upright.set_xlim(0.0, RUN_TIME)
    upright.set_ylim(0.0, 1.05)
    upright.legend(loc="lower right")
    style_axis(upright, "time [s]", "fraction of starts that are upright for good")
    arm.plot([run.arm for run in runs], [run.speed for run in runs], ".", color=ARM)
    arm.axvline(1.0, color="0.3", ls="--", lw=1, label="limit")
    arm.axhline(1.0, color="0.3", ls="--", lw=1)
    arm.set_xlim(left=0.0)
    arm.set_ylim(bottom=0.0)
    arm.legend(loc="lower left")
    style_axis(arm, "largest arm angle / its limit", "largest arm speed / its limit")
    return axes
