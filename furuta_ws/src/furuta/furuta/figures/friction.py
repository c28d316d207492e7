"""What was identified: friction over speed, and the position, measured and fitted."""

from typing import Any

import numpy as np

from furuta.figures.figure import (
    ARM,
    FRICTION,
    FRICTION_ESTIMATE,
    MEASURED,
    axes_for,
    style_axis,
    style_time_series,
)
from furuta.identification.result.friction_curve import Followed, FrictionCurve

# Standard errors that the band of the law shows to either side.
BAND = 2.0


def draw_friction(curve: FrictionCurve, followed: Followed, axes: Any = None) -> Any:
    """Draw the law with its band of error and the measured friction, then position and residual."""
    rows = {"height_ratios": [4, 2, 1]}
    figure, axes = axes_for(axes, 3, figsize=(9, 8.5), gridspec_kw=rows)
    _draw_law(axes[0], curve)
    axes[2].sharex(axes[1])
    axes[1].plot(followed.time, followed.measured, lw=2.2, color=MEASURED, label="measured")
    axes[1].plot(followed.time, followed.fitted, lw=0.9, color=ARM, label="fitted")
    axes[1].tick_params(labelbottom=False)
    left = followed.measured - followed.fitted
    axes[2].plot(followed.time, left, lw=0.7, color=ARM)
    name = "speed" if followed.unit.endswith("/s") else "position"
    style_time_series(axes[1], f"{name}\n[{followed.unit}]")
    style_time_series(axes[2], f"residual\n[{followed.unit}]")
    axes[2].set_xlabel("time [s]")
    axes[0].legend(loc="upper left")  # friction opposes the speed: no curve comes there
    axes[1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False)
    figure.align_ylabels()
    return axes


def _draw_law(axis: Any, curve: FrictionCurve) -> None:
    """Draw the law on either side of speed 0, and the means of the bins with their errors."""
    speed, law, error = (
        np.insert(values, len(values) // 2, np.nan)
        for values in (curve.speed, curve.law, curve.error)
    )
    band = {"color": FRICTION_ESTIMATE, "alpha": 0.25, "lw": 0.0}
    axis.fill_between(
        speed, law - BAND * error, law + BAND * error, label=f"± {BAND:.0f} standard errors", **band
    )
    axis.plot(speed, law, color=FRICTION_ESTIMATE, label="fitted law")
    axis.errorbar(
        curve.measured_speed,
        curve.measured,
        curve.scatter,
        fmt="o",
        ms=4,
        lw=1.0,
        color=FRICTION,
        label="torque minus inertia and load, by speed",
    )
    speed_unit, torque_unit = curve.units
    style_axis(axis, f"speed [{speed_unit}]", f"{curve.shown} [{torque_unit}]")
