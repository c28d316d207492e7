"""Campaign ``lockstep_processes``: a graph in lock-step, a process per node, that is disturbed.

Pauses must not change the run: it is that of the simulation, to the last bit. After a kill the loop
must continue. Floods of commands and second graphs must not reach it.
"""

import os
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from rclpy.parameter import Parameter

from furuta_friction.compensation import COMPENSATIONS
from furuta_graph.settings.nodes import graph_nodes
from furuta_graph.settings.settings import load_settings, loop
from furuta_ros.context import ros_context
from furuta_sim.simulation.closed_loop import simulate
from soak.mutators import pick
from soak.node_process import NodeProcess, end, second_graph
from soak.observer import Observer, motion, stamps, states
from soak.oracles import different_run, fallen, hanging_drive, not_recovered, out_of_bounds
from soak.record import Record
from soak.resources import ResourceMonitor

NAMES = [each.name for each in graph_nodes()]
# Time of the undisturbed run [s], and its wait in this machine's time.
EXACT, EXACT_WAIT = 6.0, 90.0
# Pauses within it.
PAUSES = 8
# Samples that the loop must make after an intrusion, and the time for them [s]: a killed node
# stays listed for some seconds, and several can follow each other.
SAMPLES, RECOVERY = 200, 120.0
# Time in which the messages that were on their way at a kill have arrived [s].
ON_THEIR_WAY = 1.0
# Longest pause [s]: far below the time after which the middleware drops a participant.
LONGEST_PAUSE = 0.6
KINDS = ("pause", "pause", "pause", "kill", "kill", "kill", "second graph")
# Intrusions between two new graphs.
INTRUSIONS = 30


def run(record: Record, watch: ResourceMonitor) -> None:
    """Run the slice."""
    random = record.part.random()
    with ros_context(), TemporaryDirectory() as directory:
        while record.next_step():
            graph = LockstepProcesses(record, watch, random, Path(directory))
            try:
                graph.run_exactly()
                intrusions = 0
                while intrusions < INTRUSIONS and record.next_step():
                    graph.intrude()
                    intrusions += 1
            finally:
                graph.close()


class LockstepProcesses:
    """A graph in lock-step that pauses and kills its own nodes."""

    def __init__(
        self, record: Record, watch: ResourceMonitor, random: np.random.Generator, directory: Path
    ) -> None:
        self._record, self._watch, self._random = record, watch, random
        self._compensation = str(pick(random, COMPENSATIONS))
        self._observer = Observer()
        self._nodes = [NodeProcess(name, directory, *self._arguments(name)) for name in NAMES]

    def _arguments(self, name: str) -> tuple[str, ...]:
        if name == "plant":
            return ("clock:=lockstep", "run_until:=0.0")
        return (f"compensation:={self._compensation}",) if "observer" in name else ()

    def run_exactly(self) -> None:
        """Pauses only: the true states are those of the simulation without ROS."""
        record = self._record
        self._observer.spin_for(0.5)
        answered = self._run_until(EXACT)
        for _ in range(PAUSES if answered else 0):
            self._pause()
        done = self._observer.spin(lambda: self._finished(EXACT), EXACT_WAIT)
        record.check("recovery", not_recovered(done, f"run of {EXACT:g} s", EXACT_WAIT))
        settings = load_settings([], [f"compensation={self._compensation}"])
        expected = simulate(loop(settings), EXACT)
        truths = list(self._observer.truths)
        numbers = (stamps(truths) // 1_000_000).tolist()
        problem = different_run(numbers, states(truths), expected.state)
        record.check("graph = simulation", problem)
        self._observer.clear()
        self._run_until(1e9)

    def _run_until(self, seconds: float) -> bool:
        result = self._observer.set("plant", Parameter("run_until", value=seconds))
        answered = result is not None and result.result.successful
        self._record.check("recovery", not_recovered(answered, "plant answers", RECOVERY))
        return answered

    def _finished(self, seconds: float) -> bool:
        truths = self._observer.truths
        return bool(truths) and stamps(truths[-1:])[0] >= round((seconds - 0.001) * 1e9)

    def intrude(self) -> None:
        """Pause or kill a node; the loop must continue, and its motion stay within bounds."""
        record, observer = self._record, self._observer
        kind = pick(self._random, KINDS)
        if kind == "kill":
            self._kill()
        elif kind == "pause":
            self._pause()
            observer.clear()
        else:
            observer.clear()
            second_graph(record, pick(self._random, ("", "another")))
        moved = observer.spin(lambda: len(observer.truths) > SAMPLES, RECOVERY)
        record.check("recovery", not_recovered(moved, f"{SAMPLES} samples", RECOVERY))
        self._check_motion()
        for each in self._nodes:
            each.check(record)
        pids = {each.name: each.process.pid for each in self._nodes}
        self._watch.sample({"lockstep_processes": os.getpid()} | pids)

    def _kill(self) -> None:
        node = pick(self._random, self._nodes)
        node.kill()
        self._observer.spin_for(ON_THEIR_WAY)
        self._observer.clear()
        node.start()
        if node.name == "plant":
            self._run_until(1e9)

    def _check_motion(self) -> None:
        self._record.check("bounds", out_of_bounds(states(self._observer.truths)))
        theta, volts = motion(self._observer).T
        self._record.check("hanging", hanging_drive(theta, volts, 0.001))
        if any(fallen(each) for each in theta):
            self._reset()

    def _reset(self) -> None:
        """After a fall the service puts the pendulum upright, and the loop balances it again."""
        observer = self._observer
        observer.reset()
        observer.clear()
        observer.spin(lambda: len(observer.truths) > 3000, RECOVERY)
        x = states(observer.truths)
        upright = len(x) > 3000 and bool(np.all(np.abs(x[2000:3000, 2]) < 0.3))
        self._record.check("recovery", not_recovered(upright, "balanced after a reset", 2.0))

    def _pause(self) -> None:
        node = pick(self._random, self._nodes)
        node.pause(float(self._random.uniform(0.01, LONGEST_PAUSE)))
        self._observer.spin_for(float(self._random.uniform(0.0, 0.3)))

    def close(self) -> None:
        """End all processes."""
        end(self._nodes, self._record)
        self._observer.close()
