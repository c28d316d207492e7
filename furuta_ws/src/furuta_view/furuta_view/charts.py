"""The charts of the page: angles and voltages over time, and two planes."""

from typing import Any

import numpy as np
import viser

from furuta_view.samples import COMMAND, ESTIMATE, FRICTION, PHI, PHI_DOT, THETA, TIME
from furuta_view.xy_chart import Curve, Plane, xy_chart

# Time on the axis [s], and time that the planes show [s].
SECONDS = 10.0
PLANE_SECONDS = 5.0
HEIGHT = 148  # [pixels]
# Colours of Okabe and Ito; those of one chart differ for colour-blind eyes too.
ARM, PENDULUM, TRUE, ESTIMATED = "#0072B2", "#D55E00", "#000000", "#009E73"
COMMANDED, GREY = "#56B4E9", "#999999"
# Label, colour, column and width of each curve over time; where F̂ lies on F, both are seen.
ANGLES = [("arm φ [rad]", ARM, PHI, 2.0), ("pendulum θ [rad]", PENDULUM, THETA, 2.0)]
VOLTAGES = [
    ("u [V]", COMMANDED, COMMAND, 1.5),
    ("friction F [V]", TRUE, FRICTION, 3.5),
    ("estimate F̂ [V]", ESTIMATED, ESTIMATE, 1.5),
]
FONT = "13px system-ui, sans-serif"
FRICTION_PLANE = Plane("Friction over speed", "arm speed [rad/s]", "friction [V]", 0.6, 0.3)
PHASE_PLANE = Plane("Phase plane", "arm angle φ [rad]", "arm speed [rad/s]", 0.3, 0.6)


class TimeChart:
    """Curves over the last seconds; the axis of values reaches at least from -reach to reach."""

    def __init__(
        self, gui: Any, name: str, curves: list[tuple[str, str, int, float]], reach: float
    ) -> None:
        empty = np.array([-SECONDS, 0.0])
        self._curves, self._shown = curves, [True] * len(curves)
        end = {"pad": 0.05, "soft": reach, "mode": 1}
        self._handle = gui.add_uplot(
            data=(empty, *(np.full(2, np.nan) for _ in curves)),
            series=self._series(),
            scales={
                # Fixed: viser would keep the zoom relative to the data, which may span nothing.
                "x": {"time": False, "range": (-SECONDS, 0.0)},
                "y": {"range": {"min": end | {"soft": -reach}, "max": end}},
            },
            axes=(_axis("time before now [s]", 30), _axis(name, 48)),
            legend={"show": True, "live": False},
            height=HEIGHT,
            padding=(6, 12, 0, 0),
        )

    def draw(self, samples: np.ndarray) -> None:
        """Draw samples (n, 8)."""
        if len(samples) < 2:
            return
        time = samples[:, TIME] - samples[-1, TIME]
        values = [without_gaps(time, samples[:, column]) for *_, column, _ in self._curves]
        shown = [value is not None for value in values]
        if shown != self._shown:
            self._shown = shown
            self._handle.series = self._series()
        unknown = np.zeros(len(time))
        self._handle.data = (time, *(unknown if value is None else value for value in values))

    def _series(self) -> tuple[Any, ...]:
        """The time, and the curves with what is shown of them."""
        curves = zip(self._curves, self._shown, strict=True)
        return (
            {"label": "time [s]"},
            *(
                {"label": label, "stroke": colour, "width": width, "show": is_shown}
                for (label, colour, _, width), is_shown in curves
            ),
        )


def without_gaps(time: np.ndarray, values: np.ndarray) -> np.ndarray | None:
    """Values (n,) with lines over unknown ones; None if all are unknown.

    A single NaN would leave the whole chart empty, for example the true friction of a rig.
    """
    known = np.isfinite(values)
    return np.interp(time, time[known], values[known]) if known.any() else None


def _axis(label: str, size: int) -> dict[str, Any]:
    return {"label": label, "font": FONT, "labelFont": FONT, "labelSize": 20, "size": size}


class Charts:
    """All charts; ``cycle`` (n, 6) is the exact limit cycle behind the motion, or None."""

    def __init__(self, server: viser.ViserServer) -> None:
        gui = server.gui
        self._time = [
            TimeChart(gui, "angle [rad]", ANGLES, 0.3),
            TimeChart(gui, "voltage [V]", VOLTAGES, 0.5),
        ]
        self._friction = gui.add_html("")
        self._phase = gui.add_html("")
        self.cycle: np.ndarray | None = None

    def draw(self, samples: np.ndarray) -> None:
        """Draw samples (n, 8)."""
        if not len(samples):
            return
        for chart in self._time:
            chart.draw(samples)
        newest = samples[samples[:, TIME] > samples[-1, TIME] - PLANE_SECONDS]
        self._friction.content = xy_chart(FRICTION_PLANE, _friction_curves(newest))
        self._phase.content = xy_chart(PHASE_PLANE, self._phase_curves(newest))

    def _phase_curves(self, samples: np.ndarray) -> list[Curve]:
        exact = []
        if self.cycle is not None:
            phi = self.cycle[:, 1] - 0.5 * (self.cycle[:, 1].max() + self.cycle[:, 1].min())
            exact = [Curve("exact cycle", GREY, phi, self.cycle[:, 2], 4.0)]
        return [*exact, Curve("now", ARM, samples[:, PHI], samples[:, PHI_DOT])]


def _friction_curves(samples: np.ndarray) -> list[Curve]:
    speed = samples[:, PHI_DOT]
    curves = [("true F", TRUE, FRICTION, 4.0), ("F̂", ESTIMATED, ESTIMATE, 1.5)]
    return [
        Curve(name, colour, speed, samples[:, column], width)
        for name, colour, column, width in curves
        if np.isfinite(samples[:, column]).any()
    ]
