"""The page over a running graph: sends what the graph does, and passes on what the user changes."""

import asyncio
import sys
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from functools import partial
from itertools import count
from math import isfinite
from queue import SimpleQueue
from time import monotonic
from typing import Any

import numpy as np

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.settings.nodes import CONTROLLER, HARDWARE_BRIDGE, PLANT
from furuta_bringup.options import tell_graph
from furuta_bringup.page.exact_cycle import analysed_loop, described_cycle, model_of
from furuta_bringup.page.graph_link import END_TIMEOUT, GraphLink
from furuta_bringup.page.guided_scenes import CONTENT, scene_names
from furuta_bringup.page.jobs import Work
from furuta_bringup.page.live_node import LiveNode
from furuta_bringup.page.nodes_on_page import PACE, NodesOnPage
from furuta_bringup.page.pacer import FOREVER, Pacer
from furuta_bringup.page.rig_status import late_samples, rig_status
from furuta_bringup.page.samples import TIME
from furuta_bringup.page.server import PageServer
from furuta_ros.errors import described
from furuta_ros.middleware import ros_domain
from furuta_ros.one_graph import namespace_option
from furuta_ros.process import StopSignal, bounded_end
from furuta_ros.spinning import ros_context

# Time between two collections of samples [s]; every how many of them the status is told, and nodes
# are searched for. After MISSING of them without a node the terminal says so too.
PERIOD = 1.0 / 50.0
STATUS_EVERY, SEARCH_EVERY, MISSING = 10, 50, 250
OLDEST = 2.0  # age of a sample after which the graph is silent [s]
SHOWN = 10.0  # seconds on the charts
FASTEST = 1000.0  # that a page may ask for, in multiples of real time
PUSHES = ("pushes.arm", "pushes.pendulum")
MODE = f"{CONTROLLER}.mode"


def start_command(namespace: str) -> str:
    """The command that starts the graph for which this page waits."""
    domain = ros_domain()
    prefix = f"ROS_DOMAIN_ID={domain} " if domain else ""
    return f"{prefix}./furuta run{namespace_option(namespace)}"


def run_page(server: PageServer, namespace: str, opens: bool) -> None:
    """Print the address, open the browser where there is one, and serve until Ctrl-C."""
    stop = StopSignal()
    server.announce(opens)
    with ExitStack() as ros:
        ros.enter_context(ros_context(namespace=namespace))
        tell_graph(namespace, "waiting for a graph in")
        page = LivePage(server, namespace)
        try:
            asyncio.run(page.run(stop))
        finally:
            page.close()
        with bounded_end(0):
            ros.close()


class LivePage:
    """Everything that the page hears and says. :meth:`run` serves until it is told to stop."""

    def __init__(self, server: PageServer, namespace: str = "") -> None:
        self._server, self._namespace = server, namespace
        self._link, self._pacer = GraphLink(), Pacer()
        self._later: SimpleQueue[Work] = SimpleQueue()  # by jobs, for this thread
        self._nodes = NodesOnPage(server, self._link, self._later.put, self._changed)
        self._node = LiveNode(self._nodes.received, self._begin)
        self._analysed: IdealLoop | None = None
        self._time: float | None = None
        self._received = 0.0
        self._began: list[float] | None = None
        self._is_paced = False
        self._failures: set[str] = set()
        server.received = lambda message: self._guard(partial(self._hear, message))
        server.history = self._history
        server.tell(cycle=None)

    async def run(self, stop: Callable[[], bool]) -> None:
        """Serve until ``stop()``."""
        async with self._server.serving():
            due = monotonic()
            for number in count():
                if stop():
                    return
                self._guard(partial(self._do, number))
                due = max(due + PERIOD, monotonic())
                await asyncio.sleep(max(0.0, due - monotonic()))

    def _guard(self, call: Callable[[], None]) -> None:
        """Do it; whatever others have sent, an exception ends nothing and is told once."""
        try:
            call()
        except Exception as error:
            if (failed := described(error)) not in self._failures:
                self._failures.add(failed)
                print(f"error: {failed}", file=sys.stderr, flush=True)
                self._server.say(failed=failed)

    def close(self) -> None:
        """End what the page has begun; a plant that it holds continues."""
        self._link.requests.submit("push", self._link.end_push)
        if self._server.known.get("place"):  # leave the scene
            base = self._server.known.get("base", {})
            before = {name: base[name] for name in scene_names() if name in base}
            self._link.requests.submit("leave", partial(self._apply, before))
        if self._lockstep and self._pacer.speed is not None:
            self._set_run_until(FOREVER)
            self._link.pacing.finish(END_TIMEOUT)
        self._link.requests.finish(END_TIMEOUT)
        self._link.close()

    @property
    def _lockstep(self) -> bool:
        return bool(self._nodes.value(f"{PLANT}.clock") == "lockstep")

    def _do(self, number: int) -> None:
        while not self._later.empty():
            self._later.get()()
        self._node.collect()
        rows, self._node.samples.new = self._node.samples.new, []
        began, self._began = self._began, None
        if rows:
            self._time, self._received = float(rows[-1][TIME]), monotonic()
            self._server.tell(zero=self._zero(float(rows[0][TIME])))
            self._server.send(np.array(rows).tobytes())
        if began:
            self._server.known["since"] = began[0]
            self._time = self._time and max(self._time, began[0])
            self._server.say(began=began)
        self._pace(self._time or 0.0)  # a plant that was left paused, and sends nothing, continues
        if number % SEARCH_EVERY == 0:
            self._node.choose_topics()
            self._link.search.submit("search", self._nodes.find)
        if number % STATUS_EVERY == 0:
            self._server.tell(status=self._status())
        if number == MISSING and not self._nodes.running:
            wish = f"no graph yet; this starts one: {start_command(self._namespace)}"
            print(wish, file=sys.stderr, flush=True)

    def _zero(self, first: float) -> float:
        """From when the page counts the time [s]: lock-step counts from 0, real time from 1970."""
        return 0.0 if first < FOREVER else float(self._server.known.get("zero") or first)

    def _history(self) -> bytes:
        """What a page that opens shows at once."""
        return self._node.samples.last(SHOWN).tobytes()

    def _status(self) -> dict[str, Any]:
        nodes, node = self._nodes, self._node
        is_rig = HARDWARE_BRIDGE in nodes.running
        notices = [node.warnings[name] for name in nodes.running if name in node.warnings]
        if nodes.silent:
            notices.append(f"does not answer, is asked again: {', '.join(nodes.silent)}")
        status: dict[str, Any] = {}
        if self._time is None and not nodes.running:
            status["waiting"] = self._waiting()
        elif self._time is None:
            notices.append(f"found, but silent: {', '.join(nodes.running)}")
        elif self._pacer.speed != 0.0 and (age := monotonic() - self._received) > OLDEST:
            notices.append(f"The graph has been silent for {age:.0f} s.")
            if not nodes.running:
                status["waiting"] = self._waiting()
        status["notices"] = notices
        if self._lockstep:
            status |= {"title": "lock-step", "speed": self._pacer.speed}
        elif self._time is not None:
            status["title"] = "rig" if is_rig else "simulated in real time"
            status["late"] = late_samples(node.timing, node.status)
        if is_rig:
            status["rig"] = rig_status(node.status, monotonic() - node.status_time)
        return status

    def _waiting(self) -> dict[str, str]:
        place = f"namespace {self._namespace or '/'} of ROS domain {ros_domain()}"
        return {"place": place, "command": start_command(self._namespace)}

    def _hear(self, message: Mapping[str, Any]) -> None:
        """Do what a page asks for; what is not understood is left out."""
        match message:
            case {"set": dict(values)} if values:
                if is_place(place := message.get("place")):
                    self._server.tell(place=place)
                refuse = partial(self._refuse, list(values))
                work = partial(self._apply, values)
                self._link.requests.submit(tuple(sorted(values)), work, refuse)
            case {"push": str(name), "size": size} if name in PUSHES and is_finite(size):
                self._request("push", partial(self._link.push, name, float(size)))
            case {"reset": True}:
                self._request("reset", self._link.reset)
            case {"put": [phi, theta]} if is_finite(phi) and is_finite(theta):
                self._request("reset", partial(self._link.put, float(phi), float(theta)))
            case {"speed": speed} if self._lockstep and is_speed(speed):
                self._pacer.pace(speed, self._time or 0.0)
                self._server.tell(status=self._status())
            case {"step": True} if self._lockstep:
                self._pacer.step(self._time or 0.0)
                self._server.tell(status=self._status())
            case {"arm": bool(armed)}:
                bridge = self._link.bridge
                self._link.arming.submit("arm", bridge.arm if armed else bridge.disarm, self._fail)

    def _begin(self, time: float, phi: float, theta: float) -> None:
        """Tell that a new motion begins, whoever has reset the plant."""
        self._began = [time, phi, theta]

    def _request(self, key: str, work: Work) -> None:
        self._link.requests.submit(key, work, self._fail)

    def _fail(self, reason: str) -> None:
        self._later.put(partial(self._server.say, failed=reason))

    def _apply(self, wanted: Mapping[str, Any]) -> None:
        """Set parameters by full name. Called in a job."""
        new = {name: self._nodes.accepted(name, value) for name, value in wanted.items()}
        # The controller's modes depend on the estimator: set it after that, and restore it before.
        self._link.set_values(new, last_first=new.get(MODE) == "swing_up")

    def _refuse(self, names: list[str], reason: str) -> None:
        """Tell why a node refuses values, and those that it has."""
        values = {name: self._nodes.shown(name) for name in names}
        refused = names[0] if len(names) == 1 else None
        self._later.put(partial(self._server.say, values=values, refused=refused, failed=reason))

    def _pace(self, plant_time: float) -> None:
        """In lock-step, let the plant run as far as the user wishes.

        A plant that starts paused, as ``furuta view`` starts it, runs in real time at first.
        """
        if not self._lockstep:
            self._is_paced = False
            return
        known = self._nodes.value(f"{PLANT}.{PACE}")
        if not self._is_paced:
            self._is_paced = True
            self._pacer.pace(1.0 if known < FOREVER else None, plant_time)
        until = self._pacer.run_until(monotonic(), plant_time)
        if until != known:
            self._set_run_until(until)

    def _set_run_until(self, until: float) -> None:
        work = partial(self._link.parameters.set_all, PLANT, {PACE: until})
        self._link.pacing.submit("pace", work)

    def _changed(self) -> None:
        """Compute the cycle of the parameters; what is measured begins anew."""
        values = self._nodes.values
        self._server.known["since"] = self._time or 0.0
        model = model_of(values)
        self._server.tell(lengths=[model.arm_length, model.pendulum_length])
        loop = analysed_loop(values)
        if loop != self._analysed:
            self._analysed = loop
            self._server.tell(cycle="computing" if loop else None)
            self._link.computation.submit("cycle", partial(self._compute_cycle, loop))

    def _compute_cycle(self, loop: IdealLoop | None) -> None:
        found = described_cycle(loop) if loop else None
        self._later.put(lambda: self._server.tell(cycle=found) if loop is self._analysed else None)


def is_finite(value: Any) -> bool:
    """Whether a value from a page is a number that a node can take."""
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return is_number and abs(value) < FOREVER and isfinite(value)


def is_speed(value: Any) -> bool:
    """Whether a value from a page is a multiple of real time, or None: as fast as possible."""
    return value is None or (is_finite(value) and 0.0 <= value <= FASTEST)


def is_place(value: Any) -> bool:
    """Whether a value from a page names a step of a scene."""
    match value:
        case {"scene": int(scene), "step": int(step), "isOwn": bool(), **rest} if not rest:
            scenes = CONTENT["scenes"]
            return 0 <= scene < len(scenes) and 0 <= step < len(scenes[scene]["steps"])
    return False
