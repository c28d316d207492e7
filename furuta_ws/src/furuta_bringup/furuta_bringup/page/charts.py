"""The charts of the page: angles and voltages over time, and two planes.

The axes are set here: a single unknown value, such as the friction of a rig, would leave a chart
empty whose range viser finds itself. On an axis that is set, points may also be in any order.
"""

from typing import Any, NamedTuple

import numpy as np
import viser
from matplotlib.ticker import MaxNLocator

from furuta_bringup.page.guided_scenes import MEASURED
from furuta_bringup.page.samples import COMMAND, ESTIMATE, FRICTION, PHI, PHI_DOT, THETA, TIME

SECONDS = 10.0  # on the axis of time
HEIGHT = 128  # [pixels]
# Colours of Okabe and Ito; those of one chart differ for colour-blind eyes too.
ARM, PENDULUM, TRUE, ESTIMATED = "#0072B2", "#D55E00", "#000000", "#009E73"
COMMANDED, GREY = "#56B4E9", "#BBBBBB"
FONT = "13px system-ui, sans-serif"
# Axes end at round numbers.
ROUND = MaxNLocator(6, steps=[1, 2, 5, 10], symmetric=True)


class Curve(NamedTuple):
    """Label, colour, and width [pixels] of a curve."""

    label: str
    colour: str
    width: float = 2.0


# Where F̂ lies on F, both are seen.
ANGLES = {PHI: Curve("arm φ [°]", ARM), THETA: Curve("pendulum θ [°]", PENDULUM)}
VOLTAGES = {
    COMMAND: Curve("voltage u [V]", COMMANDED, 1.5),
    FRICTION: Curve("friction F [V]", TRUE, 3.5),
    ESTIMATE: Curve("estimate F̂ [V]", ESTIMATED, 1.5),
}
FRICTIONS = {
    FRICTION: Curve("friction F", TRUE, 4.0),
    ESTIMATE: Curve("estimate F̂", ESTIMATED, 1.5),
}
PHASES = (Curve("exact cycle without compensation", GREY, 7.0), Curve("arm", ARM))


class Chart:
    """Curves over one quantity; the vertical axis is symmetric about 0.

    ``names`` are the title and those of the axes, and ``least`` is how far these reach at least.
    The horizontal one is symmetric too, or the time before now if it has no least reach.
    """

    def __init__(
        self, gui: Any, names: tuple[str, str, str], least: tuple[float, float], curves: Any
    ) -> None:
        self._least, self._reaches = least, least
        self._handle = gui.add_uplot(
            title=names[0],
            data=(np.zeros(2), *(np.full(2, np.nan) for _ in curves)),
            series=({"label": names[1]}, *map(_series, curves)),
            scales=_scales(least),
            axes=(_axis(names[1], 22, 50), _axis(names[2], 42, 24)),
            legend={"show": True, "live": False},
            cursor={"show": not least[0]},  # it looks for ascending values, such as times
            height=HEIGHT,
            padding=(6, 12, 0, 0),
        )

    def draw(self, x: np.ndarray, curves: list[np.ndarray]) -> None:
        """Draw the curves (n,) over x (n,); NaN where a curve has no point."""
        found = (_reach(self._least[0], [x]), _reach(self._least[1], curves))
        if found != self._reaches:
            self._reaches = found
            self._handle.scales = _scales(found)
        self._handle.data = (x, *curves)


def _series(curve: Curve) -> dict[str, Any]:
    return {"label": curve.label, "stroke": curve.colour, "width": curve.width}


def _scales(reaches: tuple[float, float]) -> dict[str, Any]:
    across, up = reaches
    time = (-SECONDS, 0.0)
    return {
        "x": {"time": False, "range": (-across, across) if across else time},
        "y": {"range": (-up, up)},
    }


def _reach(least: float, series: list[np.ndarray]) -> float:
    """The round end of an axis that no value exceeds; 0 if it is that of the time."""
    if not least:
        return 0.0
    sizes = np.abs(np.concatenate(series))
    largest = max(least, float(sizes.max(where=np.isfinite(sizes), initial=0.0)))
    return float(ROUND.tick_values(-largest, largest)[-1])


def _axis(label: str, size: int, space: int) -> dict[str, Any]:
    """An axis whose numbers take ``size`` and are at least ``space`` apart [pixels]."""
    about = {"label": label, "font": FONT, "labelFont": FONT, "labelSize": 18, "size": size}
    return about | {"ticks": {"size": 4}, "gap": 3, "space": space}


class Charts:
    """All charts; ``cycle`` (n, 6) is the exact limit cycle behind the motion, or None."""

    def __init__(self, server: viser.ViserServer) -> None:
        gui = server.gui
        time, volts, speed = "time before now [s]", "voltage [V]", "speed [rad/s]"
        about = ("angles over time", time, "angle [°]")
        self._angles = Chart(gui, about, (0.0, 20.0), ANGLES.values())
        about = ("voltages over time", time, volts)
        self._voltages = Chart(gui, about, (0.0, 0.5), VOLTAGES.values())
        about = ("friction over speed", f"arm {speed}", "friction [V]")
        self._friction = Chart(gui, about, (0.6, 0.3), FRICTIONS.values())
        about = ("speed over angle", "arm angle φ [°]", speed)
        self._phase = Chart(gui, about, (20.0, 0.6), PHASES)
        self.cycle: np.ndarray | None = None

    def draw(self, samples: np.ndarray) -> None:
        """Draw samples (n, 8)."""
        if len(samples) < 2:
            return
        time = samples[:, TIME] - samples[-1, TIME]
        self._angles.draw(time, [np.degrees(samples[:, column]) for column in ANGLES])
        self._voltages.draw(time, [samples[:, column] for column in VOLTAGES])
        newest = samples[time > -MEASURED.window]
        self._friction.draw(newest[:, PHI_DOT], [newest[:, column] for column in FRICTIONS])
        self._draw_phase(newest)

    def _draw_phase(self, samples: np.ndarray) -> None:
        cycle = np.zeros((0, 6)) if self.cycle is None else self.cycle
        phi, speed = cycle[:, 1] - _middle(cycle[:, 1]), cycle[:, 2]
        exact = np.concatenate([speed, np.full(len(samples), np.nan)])
        now = np.concatenate([np.full(len(speed), np.nan), samples[:, PHI_DOT]])
        angles = np.degrees(np.concatenate([phi, samples[:, PHI]]))
        self._phase.draw(angles, [exact, now])


def _middle(values: np.ndarray) -> float:
    return 0.5 * float(values.max() + values.min()) if len(values) else 0.0
