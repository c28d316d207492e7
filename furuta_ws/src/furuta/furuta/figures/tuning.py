"""Figure of a tuning: the arm's swing over the scale of each compensation."""

from typing import Any

from matplotlib.ticker import LogLocator, NullLocator

from furuta.figures.figure import axes_for, style_axis
from furuta.studies.trials import TuningResult

# Marks of the axis of the scale; 0 is no compensation.
TICKS = 0, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 4


def draw_tuning(result: TuningResult, axes: Any = None) -> Any:
    """Draw a point per trial in the guard; an arrow where it swung more before it was given up."""
    trials = [trial for trial in result.trials if trial.swing < float("inf")]
    _, axis = axes_for(axes, figsize=(7.5, 4.5))
    for number, name in enumerate(dict.fromkeys(trial.name for trial in trials)):
        own = sorted(trial for trial in trials if trial.name == name)
        for given_up, marker in ((False, "o"), (True, "^")):
            some = [trial for trial in own if trial.given_up == given_up]
            label = name + (", given up" if given_up else "")
            points = [trial.scale for trial in some], [1e3 * trial.swing for trial in some]
            if some:
                axis.plot(*points, marker, color=f"C{number}", label=label)
    after = result.after
    axis.plot(after.scale, 1e3 * after.swing, "ko", ms=14, mfc="none", label="result")
    axis.axhline(1e3 * result.encoder_count, color="0.3", ls="--", lw=1, label="one count")
    axis.set_yscale("log")
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_minor_locator(NullLocator())
    axis.yaxis.set_major_formatter("{x:g}")
    axis.set_xscale("symlog", linthresh=TICKS[1])
    axis.set_xticks(TICKS, map(str, TICKS))
    axis.set_xlim(-0.1 * TICKS[1], 1.2 * TICKS[-1])
    axis.legend(fontsize="small")
    style_axis(axis, "scale", "arm, peak to peak [mrad]")
    return axis
