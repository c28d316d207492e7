"""Speed of the node graph, compared with a chain of nodes that compute nothing.

Graph and chain are measured in alternation in one process.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic, perf_counter, perf_counter_ns, sleep
from typing import Any

import numpy as np
from bare_chain import BareChain
from rclpy.clock import Clock, ClockType
from rclpy.executors import Executor
from rclpy.parameter import Parameter

from furuta.settings.settings import Settings, default_settings
from furuta_bringup.graph.composed_graph import SimulatedGraph
from furuta_ros.spinning import ros_context, spin_until

ROUNDS = 7
ROUND_SECONDS = 1.5
LOCKSTEP_SECONDS = 12.0  # simulated in a round
# Sample time in real time [s].
PERIOD = 0.001
# Time to process what is waiting before and after a pause of the graph [s].
PAUSE = 0.05


def lockstep() -> dict[str, float]:
    """Samples per second of graph and bare chains, and the median of the ratios of all rounds."""
    with _graph_and_bare_chain("lockstep") as (graph, bare):
        raw = _bare_chain(serialised=True)
        bare.publish_sample()
        raw.publish_sample()

        def rates() -> tuple[float, float, float]:
            return (
                _graph_rate(graph),
                _rate(bare.executor, lambda: bare.count),
                _rate(raw.executor, lambda: raw.count),
            )

        rates()  # warm-up
        rounds = np.array([rates() for _ in range(ROUNDS)])
        raw.close()
    ours, typed, serialised = rounds.T
    return {
        "lockstep_vs_bare_chain": float(np.median(ours / typed)),
        "lockstep_vs_raw_chain": float(np.median(ours / serialised)),
        "lockstep_samples_per_s": float(np.median(ours)),
        "bare_chain_samples_per_s": float(np.median(typed)),
        "raw_chain_samples_per_s": float(np.median(serialised)),
    }


def realtime() -> dict[str, float]:
    """Latency from measurement to command at 1 kHz, and the fraction of commands in time."""
    ours, theirs = Stopwatch(), Stopwatch()
    with _graph_and_bare_chain("realtime") as (graph, bare):
        plant: Any = graph.plant
        pacing = plant.pacing
        plant.publish_sample = ours.starting(plant.publish_sample)
        pacing.on_command = ours.stopping(pacing.on_command)
        bare.on_command = theirs.stopping(lambda: None)
        for _ in range(ROUNDS):
            _run_for(graph, ROUND_SECONDS)
            _pace(bare, theirs.starting(bare.publish_sample))
            ours.end_round()
            theirs.end_round()
        count = pacing.timing_counts
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
    """Measures the times from one call to another, in rounds."""

    def __init__(self) -> None:
        self._start = 0
        self._round: list[float] = []
        self._rounds: list[list[float]] = []

    def starting(self, function: Callable[..., None]) -> Callable[..., None]:
        """``function``, extended to start the watch."""

        def call(*arguments: Any) -> None:
            self._start = perf_counter_ns()
            function(*arguments)

        return call

    def stopping(self, function: Callable[..., None]) -> Callable[..., None]:
        """``function``, extended to stop the watch."""

        def call(*arguments: Any) -> None:
            self._round.append((perf_counter_ns() - self._start) * 1e-9)
            function(*arguments)

        return call

    def end_round(self) -> None:
        """Start another round."""
        self._rounds.append(self._round)
        self._round = []

    def percentiles(self) -> np.ndarray:
        """Median and 99th percentile of each round (n, 2) [s]."""
        return np.array([np.percentile(times, (50, 99)) for times in self._rounds])


def machine_late_fraction() -> float:
    """Fraction of the deadlines of a sleeping loop that are missed by half a sample time."""
    start, late, ticks = perf_counter(), 0, round(ROUNDS * ROUND_SECONDS / PERIOD)
    for tick in range(1, ticks):
        wait = start + tick * PERIOD - perf_counter()
        if wait > 0:
            sleep(wait)
        late += perf_counter() - start - tick * PERIOD > 0.5 * PERIOD
    return late / ticks


def _run_for(graph: SimulatedGraph, seconds: float) -> None:
    """Let the paused graph continue for a while; deadlines in the pause do not count."""
    _spin_for(graph.executor, PAUSE)
    _run_until(graph, graph.plant.time + seconds)
    _spin_for(graph.executor, PAUSE)


def _run_until(graph: SimulatedGraph, time: float) -> None:
    graph.plant.set_parameters([Parameter("run_until", value=time)])
    spin_until(graph.executor, lambda: graph.plant.paused)


def _pace(bare: BareChain, tick: Callable[[], None]) -> None:
    timer = bare.nodes[0].create_timer(PERIOD, tick, clock=Clock(clock_type=ClockType.STEADY_TIME))
    _spin_for(bare.executor, ROUND_SECONDS)
    timer.cancel()


@contextmanager
def _graph_and_bare_chain(clock: str) -> Iterator[tuple[SimulatedGraph, BareChain]]:
    with ros_context():
        bare = _bare_chain()
        graph = SimulatedGraph(_settings(clock))
        yield graph, bare
        graph.close()
        bare.close()


def _bare_chain(serialised: bool = False) -> BareChain:
    bare = BareChain(serialised)
    while not bare.matched:
        sleep(0.01)
    return bare


def _settings(clock: str) -> Settings:
    settings = default_settings()
    settings["plant"]["clock"] = clock
    settings["plant"]["run_until"] = 0.0
    return settings


def _graph_rate(graph: SimulatedGraph) -> float:
    """Samples per second in lock-step. Before and after no message is on its way."""
    before, start = graph.plant.sample, perf_counter()
    _run_until(graph, graph.plant.time + LOCKSTEP_SECONDS)
    return (graph.plant.sample - before) / (perf_counter() - start)


def _rate(executor: Executor, count: Callable[[], int]) -> float:
    before, start = count(), perf_counter()
    _spin_for(executor, ROUND_SECONDS)
    return (count() - before) / (perf_counter() - start)


def _spin_for(executor: Executor, seconds: float) -> None:
    end = monotonic() + seconds
    spin_until(executor, lambda: monotonic() > end)
