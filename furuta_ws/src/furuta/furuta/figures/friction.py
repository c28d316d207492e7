"""What was identified: friction over speed, and the position, measured and fitted."""

from collections.abc import Mapping
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
# Speed up to which friction is drawn that was measured in slides of at most 0.6 rad/s.
FASTEST = 1.0


def draw_friction(curve: FrictionCurve, followed: Followed, axes: Any = None) -> Any:
    """Draw the law with its band of error and the measured friction, then position and residual."""
    rows = {"height_ratios": [4, 2, 1]}
    figure, axes = axes_for(axes, 3, figsize=(9, 8.5), gridspec_kw=rows)
    draw_law(axes[0], curve)
    draw_followed(axes[1], axes[2], followed)
    figure.align_ylabels()
    return axes


def draw_joints(curves: Mapping[str, FrictionCurve], axes: Any = None) -> Any:
    """Draw the friction of several joints, each beside the other."""
    size = (6.0 * len(curves), 4.5)
    _, axes = axes_for(axes, 1, len(curves), figsize=size, squeeze=False)
    for axis, (joint, curve) in zip(axes[0], curves.items(), strict=True):
        draw_law(axis, curve)
        axis.set_title(joint)
    return axes


def draw_levels(levels: Mapping[int, tuple[float, float]], viscous: float, axes: Any = None) -> Any:
    """Draw measured friction over speed, by direction its Coulomb level and stiction [V]."""
    _, axis = axes_for(axes, figsize=(7, 4.5))
    for side, (coulomb, stiction) in levels.items():
        speed = side * np.array([0.0, FASTEST])
        sliding = side * coulomb + viscous * speed
        named = side > 0
        axis.plot(speed, sliding, color=FRICTION, label="sliding" if named else None)
        breakaway = {"color": ARM, "label": "stiction" if named else None}
        axis.plot([0.0], [side * stiction], "o", **breakaway)
    axis.axhline(0.0, color="0.6", lw=0.6)
    axis.legend(loc="upper left")
    style_axis(axis, "speed [rad/s]", "friction [V]")
    return axis


def draw_followed(position: Any, residual: Any, followed: Followed) -> None:
    """Draw a position, measured and fitted, above the residual."""
    residual.sharex(position)
    position.plot(followed.time, followed.measured, lw=2.2, color=MEASURED, label="measured")
    position.plot(followed.time, followed.fitted, lw=0.9, color=ARM, label="fitted")
    position.tick_params(labelbottom=False)
    left = followed.measured - followed.fitted
    residual.plot(followed.time, left, lw=0.7, color=ARM)
    name = "speed" if followed.unit.endswith("/s") else "position"
    style_time_series(position, f"{name}\n[{followed.unit}]")
    style_time_series(residual, f"residual\n[{followed.unit}]")
    residual.set_xlabel("time [s]")
    position.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False)


def draw_law(axis: Any, curve: FrictionCurve) -> None:
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
        label="measured, by speed",
    )
    speed_unit, torque_unit = curve.units
    style_axis(axis, f"speed [{speed_unit}]", f"{curve.shown} [{torque_unit}]")
    axis.legend(loc="upper left")  # friction opposes the speed: no curve comes there
