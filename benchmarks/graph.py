"""Speed of the node graph, beside a chain of nodes that do nothing, in turns in one process."""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from time import monotonic, perf_counter, perf_counter_ns, sleep, thread_time
from typing import Any

import numpy as np
import rclpy
from bare_chain import BareChain
from rclpy.clock import Clock, ClockType
from rclpy.executors import Executor
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions

from furuta_graph.composed_graph import SimulatedGraph
from furuta_graph.settings import Settings, default_settings
from furuta_ros.spinning import spin_until

TURNS = 7
TURN_SECONDS = 1.5
PERIOD = 0.001
BREATH = 0.05  # for what waits for a paused graph [s]


def lockstep() -> dict[str, float]:
    """Samples per second of graph and bare chain, and the median of the ratios turn by turn."""
    _start()
    bare = _bare_chain()
    bare.publish_sample()
    graph = SimulatedGraph(_settings("lockstep"))

    def bare_rate() -> float:
        return _rate(bare.executor, lambda: bare.count)

    def graph_rate() -> float:
        return _rate(graph.executor, lambda: graph.plant.sample)

    bare_rate(), graph_rate()  # warm
    pairs = [(graph_rate(), bare_rate()) for _ in range(TURNS)]
    costs = _costs(graph)
    _stop(graph, bare)
    return costs | {
        "lockstep_vs_bare_chain": median(ours / theirs for ours, theirs in pairs),
        "lockstep_samples_per_s": median(ours for ours, _ in pairs),
        "bare_chain_samples_per_s": median(theirs for _, theirs in pairs),
    }


def _costs(graph: SimulatedGraph) -> dict[str, float]:
    """CPU time per sample [µs] in each node's callbacks, publishing included, and in all."""
    spent = dict.fromkeys((node.get_name() for node in graph.nodes), 0.0)

    def timed(name: str, callback: Callable[[Any], None]) -> Callable[[Any], None]:
        def call(message: Any) -> None:
            began = thread_time()
            callback(message)
            spent[name] += thread_time() - began

        return call

    for node in graph.nodes:
        for subscription in node.subscriptions:
            subscription.callback = timed(node.get_name(), subscription.callback)
    samples, began = graph.plant.sample, thread_time()
    _spin_for(graph.executor, TURN_SECONDS)
    samples = graph.plant.sample - samples
    costs = {f"cost_{name}_us": seconds / samples * 1e6 for name, seconds in spent.items()}
    return costs | {"cost_sample_us": (thread_time() - began) / samples * 1e6}


def realtime() -> dict[str, float]:
    """Latency from measurement to command at 1 kHz, and how many samples got theirs in time."""
    _start()
    bare = _bare_chain()
    graph = SimulatedGraph(_settings("realtime"))
    ours, theirs = Stopwatch(), Stopwatch()
    plant: Any = graph.plant
    pacing = plant.pacing
    plant.publish_sample = ours.starting(plant.publish_sample)
    pacing.on_command = ours.stopping(pacing.on_command)
    bare.on_command = theirs.stopping(lambda: None)
    for _ in range(TURNS):
        _run_for(graph, TURN_SECONDS)
        _pace(bare, theirs.starting(bare.publish_sample))
        ours.end_turn()
        theirs.end_turn()
    count = pacing.timing_counts
    _stop(graph, bare)
    graphs, bares = ours.percentiles(), theirs.percentiles()
    return {
        "latency_p50_s": float(np.median(graphs[:, 0])),
        "latency_p99_s": float(np.median(graphs[:, 1])),
        "latency_p50_vs_bare_chain": float(np.median(graphs[:, 0] / bares[:, 0])),
        "latency_p99_vs_bare_chain": float(np.median(graphs[:, 1] / bares[:, 1])),
        "realtime_on_time_fraction": count.on_time / count.samples,
        "realtime_overrun_fraction": count.overruns / (count.samples + count.overruns),
        "machine_late_fraction": machine_late_fraction(),
    }


class Stopwatch:
    """Times from one call to another, turn by turn."""

    def __init__(self) -> None:
        self._began = 0
        self._turn: list[float] = []
        self._turns: list[list[float]] = []

    def starting(self, function: Callable[..., None]) -> Callable[..., None]:
        """``function``, which also starts the watch."""

        def call(*arguments: Any) -> None:
            self._began = perf_counter_ns()
            function(*arguments)

        return call

    def stopping(self, function: Callable[..., None]) -> Callable[..., None]:
        """``function``, which also reads the watch."""

        def call(*arguments: Any) -> None:
            self._turn.append((perf_counter_ns() - self._began) * 1e-9)
            function(*arguments)

        return call

    def end_turn(self) -> None:
        """Begin another turn."""
        self._turns.append(self._turn)
        self._turn = []

    def percentiles(self) -> np.ndarray:
        """Median and 99 % of each turn (n, 2) [s]."""
        return np.array([np.percentile(turn, (50, 99)) for turn in self._turns])


def machine_late_fraction() -> float:
    """Share of a bare sleeping loop's deadlines that the machine serves half a sample late."""
    start, late, ticks = perf_counter(), 0, round(TURNS * TURN_SECONDS / PERIOD)
    for tick in range(1, ticks):
        wait = start + tick * PERIOD - perf_counter()
        if wait > 0:
            sleep(wait)
        late += perf_counter() - start - tick * PERIOD > 0.5 * PERIOD
    return late / ticks


def _run_for(graph: SimulatedGraph, seconds: float) -> None:
    """Let the paused graph go on for a while; it loses no deadline over its pause."""
    plant = graph.plant
    _spin_for(graph.executor, BREATH)
    plant.set_parameters([Parameter("run_until", value=plant.time + seconds)])
    spin_until(graph.executor, lambda: plant.paused)


def _pace(bare: BareChain, tick: Callable[[], None]) -> None:
    timer = bare.nodes[0].create_timer(PERIOD, tick, clock=Clock(clock_type=ClockType.STEADY_TIME))
    _spin_for(bare.executor, TURN_SECONDS)
    timer.cancel()


def _start() -> None:
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)


def _stop(graph: SimulatedGraph, bare: BareChain) -> None:
    graph.close()
    bare.close()
    rclpy.try_shutdown()


def _bare_chain() -> BareChain:
    bare = BareChain()
    while not bare.matched:
        sleep(0.01)
    return bare


def _settings(clock: str) -> Settings:
    settings = default_settings()
    settings["plant"]["clock"] = clock
    settings["plant"]["run_until"] = 0.0 if clock == "realtime" else 1e9
    return settings


def _rate(executor: Executor, count: Callable[[], int]) -> float:
    before, began = count(), perf_counter()
    _spin_for(executor, TURN_SECONDS)
    return (count() - before) / (perf_counter() - began)


def _spin_for(executor: Executor, seconds: float) -> None:
    end = monotonic() + seconds
    spin_until(executor, lambda: monotonic() > end)
