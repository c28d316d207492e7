"""The page over a running graph: collects, draws and passes on what the user changes."""

from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from itertools import count
from time import monotonic, sleep

import numpy as np

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.settings.nodes import HARDWARE_BRIDGE, PLANT
from furuta_bringup.options import tell_graph
from furuta_bringup.page.charts import SECONDS, Charts
from furuta_bringup.page.exact_cycle import (
    analysed_loop,
    cycle_size,
    encoder_counts,
    exact_cycle,
    model_of,
    predicted_size,
)
from furuta_bringup.page.figures import (
    Elapsed,
    Figures,
    figures,
    late_samples,
    measuring,
    swing,
)
from furuta_bringup.page.graph_link import END_TIMEOUT, GraphLink
from furuta_bringup.page.guide import COMPUTING, Guide
from furuta_bringup.page.guided_scenes import MEASURED, Values
from furuta_bringup.page.live_node import LiveNode
from furuta_bringup.page.page_layout import ALARM, WAITING, Layout, Note, status_html
from furuta_bringup.page.parameters_on_page import ParametersOnPage
from furuta_bringup.page.rig_controls import RigControls
from furuta_bringup.page.samples import THETA, TIME
from furuta_bringup.page.scene import Scene
from furuta_bringup.page.server import PageServer
from furuta_bringup.page.simulation_controls import (
    FOREVER,
    FallNotice,
    SimulationControls,
    has_fallen,
)
from furuta_description.robot_description import robot_description
from furuta_model.pendulum import FurutaPendulum
from furuta_ros.process import StopSignal, bounded_end
from furuta_ros.spinning import ros_context

# Time between two drawings [s]; every how many of them charts and figures are drawn, of the same
# samples, and nodes are searched for.
PERIOD = 1.0 / 30.0
CHARTS_EVERY, SEARCH_EVERY = 3, 30
# Names of predictions, of which the describing function comes first.
DESCRIBING_FUNCTION, EXACT_CYCLE = "describing function", "exact cycle"
# Parameters that set how far the plant runs, and which push it.
PACE, PUSH = "run_until", "pushes."


def run_page(server: PageServer, namespace: str, opens: bool) -> None:
    """Print the address, open the browser where there is one, and draw until Ctrl-C."""
    stop = StopSignal()
    server.announce(opens)
    with ExitStack() as ros:
        ros.enter_context(ros_context(namespace=namespace))
        tell_graph(namespace)
        page = LivePage(server)
        try:
            page.run(stop)
        finally:
            page.close()
        server.stop()
        with bounded_end(0):
            ros.close()


class LivePage:
    """Everything on the page. :meth:`run` draws until it is told to stop."""

    def __init__(self, server: PageServer) -> None:
        self._server, gui = server, server.gui
        self._link = GraphLink()
        self._layout = Layout(server)
        with self._layout.controls:
            note = Note(gui, 90.0)
            self._simulation = SimulationControls(server, self._link, note)
        self._fall = FallNotice(gui, self._simulation.reset)
        self._warning = Note(gui, 0.5, "warning")
        self._elapsed = Elapsed()
        pace = self._simulation.run_in_real_time
        self._guide = Guide(gui, self._link, self._values, pace)
        self._parameters = ParametersOnPage(
            gui, self._link, self._layout.main, self._layout.parameters, self._changed
        )
        self._node = LiveNode(self._parameters.received)
        with self._layout.charts:
            self._charts = Charts(server)
        self._scene = Scene(server)
        self._rig: RigControls | None = None
        self._drawn_model: FurutaPendulum | None = None
        self._analysed: IdealLoop | None = None
        self._predicted = dict.fromkeys((DESCRIBING_FUNCTION, EXACT_CYCLE), COMPUTING)
        self._start = 0.0

    def run(self, stop: Callable[[], bool]) -> None:
        """Draw until ``stop()``."""
        due = monotonic()
        for number in count():
            if stop():
                return
            self._draw(number)
            due = max(due + PERIOD, monotonic())
            sleep(max(0.0, due - monotonic()))

    def close(self) -> None:
        """End what the page has begun; a plant that it holds continues."""
        self._guide.leave()
        if self._lockstep and self._simulation.pacer.speed is not None:
            self._set_run_until(FOREVER)
            self._link.pacing.finish(END_TIMEOUT)
        self._link.requests.finish(END_TIMEOUT)
        self._link.close()

    @property
    def status(self) -> str:
        """What the top of the page says, in HTML."""
        return str(self._layout.status.content)

    @property
    def _lockstep(self) -> bool:
        return bool(self._parameters.values.get(PLANT, {}).get("clock") == "lockstep")

    def _values(self) -> Values:
        return self._parameters.values

    def _changed(self, names: set[str]) -> None:
        """Figures and cycle are those of parameters before: take them away."""
        if names <= {PACE}:
            return
        self._elapsed.restart()
        if not all(name.startswith(PUSH) for name in names):  # such as the push of a step
            self._guide.elapsed.restart()
        self._update_model()

    def _draw(self, number: int) -> None:
        self._node.collect()
        newest = self._node.samples.last(SECONDS)
        time = float(newest[-1, TIME]) if len(newest) else None
        if number % SEARCH_EVERY == 0:
            self._node.choose_topics()
            self._link.search.submit("search", self._parameters.find_nodes)
        self._pace(time or 0.0)  # a plant that was left paused, and sends nothing, continues
        shown = time is not None and bool(self._server.get_clients())
        if shown:
            self._scene.move(newest[-1])
        if number % CHARTS_EVERY == 0:
            if shown:
                self._charts.draw(newest)
            self._update_model()
            self._update_rig()
            self._update_status(newest, time)

    def _update_status(self, newest: np.ndarray, time: float | None) -> None:
        if time is None:
            found = ", ".join(self._parameters.running)
            rows = [("found, but silent", found)] if found else []
            self._layout.status.content = status_html(WAITING, rows)
            return
        values = self._parameters.values
        rows = []
        if self._guide.position is None:  # its table has them otherwise
            wait = measuring(self._elapsed.passed(newest[:, TIME]), MEASURED.window)
            known = Figures() if wait else figures(newest, encoder_counts(values))
            rows = known.rows(wait)
        if self._parameters.silent:
            rows.append(("does not answer, is asked again", ", ".join(self._parameters.silent)))
        self._warning.tell("; ".join(self._node.warnings.values()), ALARM)
        fallen = has_fallen(float(newest[-1, THETA]), values)
        self._fall.show(fallen, values)
        self._guide.update(newest, fallen, list(self._predicted.items()))
        if self._lockstep:
            title = "lock-step"
        else:
            title = "rig" if self._rig else "simulated"
            rows.append(("late samples", late_samples(self._node.timing, self._node.status)))
        self._layout.status.content = status_html(
            f"<b>{title}, t = {self._seconds(time):.1f} s</b>", rows
        )

    def _seconds(self, time: float) -> float:
        """Time since the start [s]; in real time since the first sample on the page."""
        if time < FOREVER:  # lock-step counts from 0, and never so far
            return time
        self._start = self._start or time
        return time - self._start

    def _update_rig(self) -> None:
        values = self._parameters.values
        self._simulation.show_pacing(self._lockstep)
        self._layout.controls.visible = PLANT in values or not values
        # As soon as the bridge is known: its parameters come later, and the rig may be armed.
        if HARDWARE_BRIDGE in self._parameters.running and self._rig is None:
            self._rig = RigControls(self._server, self._link)
        if self._rig is not None:
            self._rig.show(self._node.status, monotonic() - self._node.status_time)

    def _pace(self, plant_time: float) -> None:
        """In lock-step, let the plant run as far as the user wishes."""
        if self._lockstep:
            until = self._simulation.pacer.run_until(monotonic(), plant_time)
            if until != self._parameters.values.get(PLANT, {}).get("run_until"):
                self._set_run_until(until)

    def _set_run_until(self, until: float) -> None:
        work = partial(self._link.parameters.set_all, PLANT, {"run_until": until})
        self._link.pacing.submit("pace", work)

    def _update_model(self) -> None:
        """Draw the pendulum at its lengths, and the cycle of its parameters, once known."""
        values = self._parameters.values
        if not values:
            return
        model = model_of(values)
        if model != self._drawn_model:
            self._scene.show(robot_description(model.arm_length, model.pendulum_length))
            self._drawn_model = model
        loop = analysed_loop(values)
        if loop != self._analysed:
            self._analysed, self._charts.cycle = loop, None
            self._predicted = dict.fromkeys(self._predicted, COMPUTING)
            self._link.computation.submit("cycle", partial(self._compute_cycle, loop))

    def _compute_cycle(self, loop: IdealLoop | None) -> None:
        cycle = exact_cycle(loop) if loop else None
        predicted = {
            DESCRIBING_FUNCTION: predicted_size(loop) if loop else None,
            EXACT_CYCLE: cycle_size(cycle),
        }
        if loop is self._analysed:  # and not changed meanwhile
            self._charts.cycle = cycle
            self._predicted = {
                name: "no cycle" if size is None else swing(size)
                for name, size in predicted.items()
            }
