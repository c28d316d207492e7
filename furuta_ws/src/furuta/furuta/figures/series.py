"""Series over time: a recording or simulation, and the demo's phases beside each other."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from furuta.figures.figure import (
    ARM,
    ESTIMATE,
    FRICTION,
    FRICTION_ESTIMATE,
    MEASURED,
    PENDULUM,
    VOLTAGE,
    axes_for,
    legend_outside,
    style_time_series,
)
from furuta.quantities import QUANTITIES
from furuta.results.text import angle
from furuta.studies.phases import PHASES, TUNED, Phase
from furuta_friction.compensation import TITLES
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, THETA
from furuta_recordings.bags.recorded_loop import RecordedRun

# Columns that a row shows where they exist: label and style. The truth has the colour of its
# quantity.
COLUMNS: dict[str, dict[str, dict[str, Any]]] = {
    QUANTITIES["arm"].axis: {
        "measured_phi_rad": {"label": "measured", "lw": 0.8, "color": MEASURED},
        "true_phi_rad": {"label": "true", "lw": 1.6, "color": ARM},
        "estimated_phi_rad": {"label": "estimated", "lw": 0.8, "color": ESTIMATE},
    },
    QUANTITIES["pendulum"].axis: {
        "measured_theta_rad": {"label": "measured", "lw": 0.8, "color": MEASURED},
        "true_theta_rad": {"label": "true", "lw": 1.6, "color": PENDULUM},
        "estimated_theta_rad": {"label": "estimated", "lw": 0.8, "color": ESTIMATE},
    },
    QUANTITIES["command"].axis: {"command_v": {"label": "command", "lw": 0.8, "color": VOLTAGE}},
    QUANTITIES["friction"].axis: {
        "true_friction_v": {"label": "true F", "lw": 2.4, "alpha": 0.7, "color": FRICTION},
        "friction_estimate_v": {
            "label": QUANTITIES["estimate"].title,
            "lw": 0.8,
            "color": FRICTION_ESTIMATE,
        },
    },
}
# Titles of the demo's phases that are not those of their compensations.
OF_PHASES = {"none": "No compensation", TUNED: "LuGre observer, tuned"}
# Length of the part that is shown of each phase of the demo, and of its friction [s].
SHOWN, FRICTION_SHOWN = 10.0, 2.5
# An interval longer than this many usual ones is a gap, over which no line is drawn.
GAP = 100.0
# Difference of two curves, relative to their range, that cannot be seen.
SAME = 2e-3
# Matplotlib finds no ticks for the largest numbers.
LARGEST = 1e100


def draw_series(series: Mapping[str, np.ndarray], axes: Any = None) -> Any:
    """Draw the columns that exist, a row per quantity.

    Raises:
        ParameterError: There is nothing to draw, or a number is too large.
    """
    time = series["time_s"]
    interval = np.diff(time, prepend=time[0])
    after_gap = interval > GAP * np.median(interval)
    for name, values in series.items():
        largest = float(np.nanmax(np.abs(values), initial=0.0))
        if largest > LARGEST:
            raise ParameterError(f"{name} has {largest:.3g}, at most {LARGEST:g} can be drawn")
    drawn = {name: np.where(after_gap, np.nan, values) for name, values in series.items()}
    labels = [label for label, columns in COLUMNS.items() if columns.keys() & series.keys()]
    if not labels:
        raise ParameterError("there are no series to draw")
    shared: dict[str, Any] = {"squeeze": False, "sharex": True, "figsize": (10, 2 * len(labels))}
    _, axes = axes_for(axes, len(labels), **shared)
    for axis, label in zip(axes[:, 0], labels, strict=True):
        _draw_row(axis, label, time, drawn)
        axis.set_ylabel(label)
        if len(axis.lines) > 1:
            axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes[-1, 0].set_xlabel("time [s]")
    return axes


def draw_demo(
    recorded: RecordedRun,
    phases: list[Phase],
    rows: list[dict[str, Any]],
    encoder_count: float,
    axes: Any = None,
) -> Any:
    """Draw one column per phase and one row per signal; a row has one scale.

    The title has the swing in the row of the phase, which is measured for longer than is shown. A
    band is one count of the arm's encoder. The friction is shown for a shorter time, so that its
    estimate can be told from it.
    """
    shape = (len(COLUMNS), len(phases))
    figure, axes = axes_for(axes, *shape, sharey="row", figsize=(17, 8.5))
    for column, phase, row in zip(axes.T, phases, rows, strict=True):
        shown = recorded.between(max(phase.start, phase.end - SHOWN), phase.end)
        series = {
            "true_phi_rad": shown.state[:, PHI],
            "true_theta_rad": shown.state[:, THETA],
            "command_v": shown.command,
            "true_friction_v": shown.friction,
            "friction_estimate_v": shown.friction_estimate,
        }
        for axis, label in zip(column, COLUMNS, strict=True):
            _draw_row(axis, label, shown.time, series)
        column[0].set_title(_title(row))
        middle = 0.5 * (np.min(shown.state[:, PHI]) + np.max(shown.state[:, PHI]))
        ends = middle - 0.5 * encoder_count, middle + 0.5 * encoder_count
        column[0].axhspan(*ends, color=ARM, alpha=0.15, lw=0, label="one encoder count")
        column[3].set_xlim(phase.end - FRICTION_SHOWN, phase.end)
        for axis in column[:2]:
            axis.tick_params(labelbottom=False)
    for axis, label in zip(axes[:, 0], COLUMNS, strict=True):
        axis.set_ylabel(label)
    for axis in axes[2:].flat:
        axis.set_xlabel("time [s]")
    handles, labels = axes[3, 0].get_legend_handles_labels()
    band, count = axes[0, 0].get_legend_handles_labels()
    entries = [*handles, *band[-1:]], [*labels, *count[-1:]]
    legend_outside(figure, "lower center", *entries, ncols=3)
    return axes


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two curves would cover each other."""
    return bool(np.nanmax(np.abs(one - other), initial=0.0) <= SAME * np.ptp(one))


def _title(row: Mapping[str, Any]) -> str:
    """What a phase of the demo is called, its figure in the paper, and how far the arm swings."""
    title, figure = (TITLES | OF_PHASES)[row["compensation"]], PHASES[row["compensation"]]
    swing = f"{angle(row['phi_peak_to_peak_rad'])} in {row['measured_seconds']:g} s"
    return f"{title}{f' ({figure})' * bool(figure)}\n{swing}"


def _draw_row(axis: Any, label: str, time: np.ndarray, series: Mapping[str, np.ndarray]) -> None:
    """Draw the series of a row of :data:`COLUMNS` that exist, the same curve only once."""
    drawn: list[np.ndarray] = []
    for name, style in sorted(COLUMNS[label].items(), key=lambda item: "true" not in item[0]):
        if name in series and not any(_same(series[name], other) for other in drawn):
            axis.plot(time, series[name], **style)
            drawn.append(series[name])
    style_time_series(axis)
