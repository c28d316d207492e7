"""Figure of a tuning: the arm's swing in each trial."""

from typing import Any

import numpy as np

from furuta.figures.figure import ARM, REFERENCE, annotate, axes_for, scale_sizes, style_axis
from furuta.results.text import angle
from furuta.studies.trials import TuningResult


def draw_tuning(result: TuningResult, axes: Any = None) -> Any:
    """Draw a bar per trial in their order, with the swing and why it ended early."""
    trials = result.trials
    _, axis = axes_for(axes, figsize=(9, 1.6 + 0.4 * len(trials)))
    known = [trial.swing for trial in trials if np.isfinite(trial.swing)]
    low = 0.5 * min(*known, result.encoder_count)
    high = 5.0 * max(*known, result.encoder_count)
    for number, trial in enumerate(trials):
        is_result, is_known = trial == result.after, np.isfinite(trial.swing)
        swing = trial.swing if is_known else low
        axis.barh(number, swing, color=ARM if is_result else REFERENCE, height=0.7)
        size = angle(swing) if is_known else ""
        text = ", ".join(filter(None, (size, "result" if is_result else trial.remark)))
        annotate(axis, (swing, number), text, xytext=(7, 0), va="center")
    axis.axvline(result.encoder_count, color="0.3", ls="--", lw=1, label="one encoder count")
    axis.set_yticks(range(len(trials)), [trial.title for trial in trials])
    axis.invert_yaxis()
    scale_sizes(axis, "x", (low, high))
    axis.set_xlim(low, high)
    axis.legend(loc="lower right")
    style_axis(axis, "arm, peak to peak [rad]")
    axis.set_title("trials in their order" if result.gain else "trials in their order: no gain")
    return axis
