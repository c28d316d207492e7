"""The page over a running graph: collects, draws and passes on what the user changes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import monotonic, sleep
from typing import Any

from furuta_description.lengths import lengths
from furuta_description.robot_description import robot_description
from furuta_model.pendulum import FurutaPendulum
from furuta_sim.settings.nodes import HARDWARE_BRIDGE, PLANT
from furuta_view.charts import SECONDS, Charts
from furuta_view.every import Every
from furuta_view.exact_cycle import exact_cycle, relevant
from furuta_view.figures import Figures, figures
from furuta_view.figures_text import figure_rows
from furuta_view.graph_link import END_TIMEOUT, GraphLink
from furuta_view.live_node import LiveNode
from furuta_view.main_controls import FileControls, Note, RigControls, SimulationControls
from furuta_view.model_of import model_of
from furuta_view.pacer import FOREVER, Pacer
from furuta_view.page_layout import Layout, status_html
from furuta_view.page_recorder import PageRecorder
from furuta_view.parameters_on_page import ParametersOnPage
from furuta_view.samples import PHI, THETA, TIME
from furuta_view.scene import Scene
from furuta_view.server import PageServer
from furuta_view.timing_text import late_samples

# Time between two drawings, two drawings of the charts, two computations of the figures, and two
# searches for nodes [s].
PERIOD = 1.0 / 30.0
CHARTS_PERIOD, FIGURES_PERIOD, SEARCH_PERIOD = 0.1, 0.5, 1.0


class LivePage:
    """Everything on the page. :meth:`run` draws until it is told to stop."""

    def __init__(self, server: PageServer, recordings: Path) -> None:
        self._server, gui = server, server.gui
        self._link = GraphLink()
        self._layout = Layout(server)
        with self._layout.controls:
            note = Note(gui, 90.0)
            self._simulation = SimulationControls(server, self._link, note, Pacer())
        self._parameters = ParametersOnPage(
            gui, self._link, self._layout.main, self._layout.parameters, self._parameters_changed
        )
        with self._layout.files:
            recorder = PageRecorder(recordings)
            self._files = FileControls(gui, self._parameters, note, recorder)
        self._node = LiveNode(self._parameters.received)
        with self._layout.charts:
            self._charts = Charts(server)
        self._scene = Scene(server)
        self._rig: RigControls | None = None
        self._drawn_model: FurutaPendulum | None = None
        self._cycle_of: tuple[Any, ...] = ()
        self._figures = Figures()
        self._charts_due, self._figures_due, self._search_due = map(
            Every, (CHARTS_PERIOD, FIGURES_PERIOD, SEARCH_PERIOD)
        )

    def run(self, stop: Callable[[], bool]) -> None:
        """Draw until ``stop()``."""
        due = monotonic()
        while not stop():
            self._draw()
            due = max(due + PERIOD, monotonic())
            sleep(max(0.0, due - monotonic()))

    def close(self) -> None:
        """End what the page has begun; a plant that it holds continues."""
        self._files.recorder.stop()
        if self._lockstep and self._simulation.pacer.holds:
            self._link.requests.submit("pace", partial(self._set_run_until, FOREVER))
            self._link.requests.finish(END_TIMEOUT)
        self._link.close()

    @property
    def _lockstep(self) -> bool:
        return bool(self._parameters.values.get(PLANT, {}).get("clock") == "lockstep")

    def _draw(self) -> None:
        self._node.collect()
        self._files.update(self._lockstep)
        newest = self._node.samples.last(SECONDS)
        if self._search_due():
            self._node.choose_topics()
            self._link.search.submit("search", self._parameters.find_nodes)
        figures_due = self._figures_due()
        if figures_due:
            self._update_rig()
        if len(newest):
            self._pace(float(newest[-1, TIME]))
            if self._server.get_clients():
                self._draw_samples(newest, figures_due)
        elif figures_due:
            self._pace(0.0)  # a plant that was left paused continues
            self._layout.status.content = status_html("waiting for a running graph", [])

    def _draw_samples(self, newest: Any, figures_due: bool) -> None:
        self._scene.move({"arm": float(newest[-1, PHI]), "pendulum": float(newest[-1, THETA])})
        if self._charts_due():
            self._charts.draw(newest)
        if figures_due:
            sensors = self._parameters.values.get("estimator", {})
            counts = int(sensors.get("sensors.encoder_counts", 0))
            self._figures = figures(newest, counts)
            self._layout.status.content = self._status(float(newest[-1, TIME]))

    def _status(self, time: float) -> str:
        kind = "rig" if self._rig else "simulated, lock-step" if self._lockstep else "simulated"
        rows = figure_rows(self._figures)
        if not self._lockstep:
            rows.append(("late samples", late_samples(self._node.timing, self._node.status)))
        seconds = f", t = {time:.1f} s" if self._lockstep else ""
        return status_html(kind + seconds, rows)

    def _update_rig(self) -> None:
        values = self._parameters.values
        self._simulation.show_pacing(self._lockstep)
        self._layout.controls.visible = PLANT in values or not values
        # As soon as the bridge is found: its parameters come later, and the rig may be armed.
        if HARDWARE_BRIDGE in self._parameters.running and self._rig is None:
            self._rig = RigControls(self._server, self._link)
        if self._rig is not None:
            self._rig.show(self._node.status, monotonic() - self._node.status_time)

    def _pace(self, plant_time: float) -> None:
        """In lock-step, let the plant run as far as the user wishes."""
        pacer = self._simulation.pacer
        if not self._lockstep:
            return
        until = pacer.run_until(monotonic(), plant_time)
        if until != self._parameters.values[PLANT].get("run_until"):
            self._link.requests.submit("pace", partial(self._set_run_until, until))

    def _set_run_until(self, until: float) -> None:
        self._link.set(PLANT, {"run_until": until})

    def _parameters_changed(self, node: str) -> None:
        """Draw the pendulum at its lengths, and the cycle of its parameters."""
        values = self._parameters.values
        model = model_of(values)
        if model != self._drawn_model:
            self._drawn_model = model
            self._scene.show(robot_description(lengths(model)))
        if relevant(values) != self._cycle_of:
            self._cycle_of = relevant(values)
            self._link.computation.submit("cycle", self._compute_cycle)

    def _compute_cycle(self) -> None:
        self._charts.cycle = exact_cycle(self._parameters.values)
