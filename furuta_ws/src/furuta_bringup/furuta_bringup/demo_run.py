"""The demo: the paper's Figs 6 to 9 and the recommended compensation, in lock-step.

One pendulum keeps running while parameter services switch the compensation, as a user would.
"""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

from rclpy.node import Node

from furuta.settings.nodes import FRICTION_OBSERVER
from furuta.settings.settings import Settings, default_settings, loop, merge_settings
from furuta.studies.phases import PHASES, TUNED, Phase
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_bringup.graph.parameter_client import ParameterClient
from furuta_bringup.parameter_files import settings_file
from furuta_recordings.recorder_node import RecorderNode


def in_lockstep(settings: Settings) -> Settings:
    """The settings of a paused graph without compensation."""
    paused = default_settings()
    paused["plant"] = {"clock": "lockstep", "run_until": 0.0}
    paused["friction_observer"] = {"compensation": "none"}
    return merge_settings(settings, paused)


def run_demo(
    settings: Settings, tuned: Callable[[], float], seconds: float, bag: Path
) -> Iterator[Phase]:
    """Run every compensation for ``seconds``, and record the graph into ``bag``.

    ``tuned`` gives the tuned σ₁ of the friction observer; it may wait for it.
    """
    node = Node("furuta_demo", start_parameter_services=False)
    settings = in_lockstep(settings)
    record = partial(RecorderNode, bag, stamped=True, parameters=settings_file(settings))
    graph = SimulatedGraph(settings, [node], record)
    try:
        client = ParameterClient(node, graph.executor)
        for number, compensation in enumerate(PHASES):
            began = perf_counter()
            end = (number + 1) * seconds
            client.set_all(FRICTION_OBSERVER, _changes(compensation, tuned, settings))
            client.set("plant", run_until=end)
            graph.run_until(end)
            yield Phase(compensation, number * seconds, end, perf_counter() - began)
    finally:
        graph.close()


def _changes(compensation: str, tuned: Callable[[], float], settings: Settings) -> dict[str, Any]:
    """The parameters of the friction observer that a phase sets."""
    if compensation == TUNED:
        return {"compensation": "lugre", "sigma1": tuned()}
    return {"compensation": compensation, "sigma1": loop(settings).observer.friction.sigma1}
