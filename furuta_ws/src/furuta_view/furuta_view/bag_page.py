"""The page over one recording, or over two that are compared, with a time line to drag."""

from collections.abc import Callable
from time import monotonic, sleep
from typing import Any

import numpy as np

from furuta_description.robot_description import robot_description
from furuta_view.bag_samples import BagSamples, at_times
from furuta_view.charts import SECONDS, Charts
from furuta_view.exact_cycle import Values, exact_cycle, model_of
from furuta_view.figures import figures
from furuta_view.page_layout import Layout, status_html
from furuta_view.samples import PHI, THETA
from furuta_view.scene import Scene
from furuta_view.server import PageServer

# Time between two drawings [s], and between two points of the time line.
PERIOD = 1.0 / 30.0
STEP = 0.01
GHOST = 0.35  # opacity of the second pendulum


class BagPage:
    """Draws one or two recordings at the time that the user has chosen."""

    def __init__(self, server: PageServer, bags: list[BagSamples]) -> None:
        self._server, self._bags = server, bags
        gui = server.gui
        layout = self._layout = Layout(server, live=False)
        with layout.charts:
            self._charts = Charts(server, two=len(bags) > 1)
        self._seconds = max(STEP, *(bag.seconds for bag in bags))
        with layout.main:
            self._time: Any = gui.add_slider("time [s]", 0.0, self._seconds, STEP, self._start())
            self._play: Any = gui.add_checkbox("play", False)
            self._speed = gui.add_slider("speed", 0.1, 4.0, 0.1, 1.0)
        self._scenes = [
            Scene(server, f"/recording_{number}", GHOST if number else 1.0)
            for number, _ in enumerate(bags)
        ]
        self._parameters = [bag.parameters() for bag in bags]
        for scene, values in zip(self._scenes, self._parameters, strict=True):
            model = model_of(values)
            scene.show(robot_description(model.arm_length, model.pendulum_length))
        self._charts.cycle = exact_cycle(self._parameters[0])
        self._drawn = -1.0

    def run(self, stop: Callable[[], bool]) -> None:
        """Draw until ``stop()``."""
        last = monotonic()
        while not stop():
            now = monotonic()
            if self._play.value:
                time = self._time.value + self._speed.value * (now - last)
                self._time.value = min(time, self._seconds)
                self._play.value = time < self._seconds
            last = now
            self._draw(self._time.value)
            sleep(PERIOD)

    def _start(self) -> float:
        """The first time at which the charts are full."""
        return min(SECONDS, self._seconds)

    def _draw(self, time: float) -> None:
        if time == self._drawn or not self._server.get_clients():
            return
        self._drawn = time
        windows = [bag.window(time, SECONDS) for bag in self._bags]
        for scene, samples in zip(self._scenes, windows, strict=True):
            known = samples[np.isfinite(samples[:, PHI]) & np.isfinite(samples[:, THETA])]
            if len(known):
                scene.move({"arm": float(known[-1, PHI]), "pendulum": float(known[-1, THETA])})
        first, *others = windows
        second = at_times(others[0], first[:, 0]) if others else None
        self._charts.draw(first, second)
        self._layout.status.content = "".join(
            status_html(str(bag.path), figures(samples, _counts(values)).rows())
            for bag, samples, values in zip(self._bags, windows, self._parameters, strict=True)
        )


def _counts(values: Values) -> int:
    return int(str(values.get("estimator", {}).get("sensors.encoder_counts", 0)))
