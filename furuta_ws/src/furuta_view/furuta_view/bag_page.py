"""The page over a recording, with a time line to drag."""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import numpy as np

from furuta_description.robot_description import robot_description
from furuta_recordings.table_files import SUFFIXES
from furuta_ros.process_end import StopSignal
from furuta_view.bag_samples import BagSamples
from furuta_view.charts import SECONDS, Charts
from furuta_view.exact_cycle import encoder_counts, exact_cycle, model_of
from furuta_view.figures import figures
from furuta_view.page_layout import Layout, status_html
from furuta_view.samples import PHI, THETA
from furuta_view.scene import Scene
from furuta_view.series_samples import SeriesSamples
from furuta_view.server import PageServer

# Time between two drawings [s], and between two points of the time line.
PERIOD = 1.0 / 30.0
STEP = 0.01


def run_bag_page(server: PageServer, bag: Path, opens: bool) -> None:
    """Show a recording, or the series of a simulation, until Ctrl-C. It needs no ROS."""
    stop = StopSignal()
    kind = SeriesSamples if bag.suffix in SUFFIXES else BagSamples
    with closing(kind(bag)) as samples:
        page = BagPage(server, samples)
        server.announce(opens)
        page.run(stop)
    server.stop()


class BagPage:
    """Draws a recording at the time that the user has chosen."""

    def __init__(self, server: PageServer, bag: BagSamples | SeriesSamples) -> None:
        self._server, self._bag = server, bag
        gui = server.gui
        layout = self._layout = Layout(server, live=False)
        with layout.charts:
            self._charts = Charts(server)
        self._seconds = max(STEP, bag.seconds)
        first = min(SECONDS, self._seconds)  # the charts are full then
        with layout.main:
            self._time: Any = gui.add_slider("time [s]", 0.0, self._seconds, STEP, first)
            self._play: Any = gui.add_checkbox("play", False)
            self._speed = gui.add_slider("speed", 0.1, 4.0, 0.1, 1.0)
        self._scene = Scene(server)
        self._parameters = bag.parameters()
        model = model_of(self._parameters)
        self._scene.show(robot_description(model.arm_length, model.pendulum_length))
        self._charts.cycle = exact_cycle(self._parameters)
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

    def _draw(self, time: float) -> None:
        if time == self._drawn or not self._server.get_clients():
            return
        self._drawn = time
        samples = self._bag.window(time, SECONDS)
        known = samples[np.isfinite(samples[:, PHI]) & np.isfinite(samples[:, THETA])]
        if len(known):
            self._scene.move(known[-1])
        self._charts.draw(samples)
        rows = figures(samples, encoder_counts(self._parameters)).rows()
        self._layout.status.content = status_html(str(self._bag.path), rows)
