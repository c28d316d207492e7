"""The recorder that the launch file starts as a process of its own."""

import signal
from pathlib import Path
from shutil import rmtree
from typing import Any

import pytest
from paused_graph import PausedGraph, launch_commands
from testbench import Bench

from furuta_bringup.graph.processes import executable
from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.metadata import PARAMETERS_FILE
from furuta_recordings.bags.recovery import recover

SAMPLES = 100


def ground_truths(bag: Path) -> list[tuple[int, Any]]:
    """Times [ns] and contents of the true states of the graph ``left``, so far."""
    recovered = bag.with_name("recovered")
    rmtree(recovered, ignore_errors=True)
    try:
        recover(bag, recovered)
    except ParameterError:  # nothing yet
        return []
    with Bag(recovered) as reader:
        return [
            (time, reader.deserialize(data, topic.msgtype))
            for topic, time, data in reader.messages()
            if topic.topic == "/left/ground_truth"
        ]


def run_until_recorded(graph: PausedGraph, bag: Path) -> tuple[int, Any]:
    """Number of samples and true states, some of which the recorder has received.

    A process that has started late does not yet know the plant when the others do.
    """
    for samples in range(SAMPLES, 100 * SAMPLES, SAMPLES):
        graph.run(samples)
        if ground_truths(bag):
            break
    return samples + SAMPLES, graph.run(samples + SAMPLES)


@pytest.mark.long
def test_launched_graph_is_recorded(bench: Bench, processes: Any, tmp_path: Path) -> None:
    """With its namespace, the stamps of its samples, and its parameters; Ctrl-C ends the bag."""
    bag, file = tmp_path / "bag", tmp_path / "mine.yaml"
    file.write_text("plant: {ros__parameters: {run_until: 0.0}}")
    arguments = {"clock": "lockstep", "params_file": str(file), "namespace": "left"}
    graph = PausedGraph(bench, "left")
    commands = launch_commands(record=str(bag), compensation="lugre", **arguments)
    *_, recorder = [processes.start(*command) for command in commands]
    # The plant and the recorder.
    bench.spin(lambda: bench.probe.count_subscribers("/left/command") == 2, timeout=120.0)
    samples, states = run_until_recorded(graph, bag)
    last = (samples - 1) * 1_000_000
    bench.spin(lambda: [time for time, _ in ground_truths(bag)[-1:]] == [last], timeout=120.0)
    recorder.send_signal(signal.SIGINT)
    _, err = recorder.communicate(timeout=120.0)
    assert recorder.returncode == 0, err
    time, message = ground_truths(bag)[-1]
    assert time == last
    assert [message.position[0], message.velocity[0]] == states[-1, :2].tolist()
    assert "compensation: lugre" in (bag / PARAMETERS_FILE).read_text()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ([], "the recorder needs the parameter directory, where it makes the bag"),
        (["directory:=/dev/null"], "/dev/null already exists; name another directory"),
        (["directory:=bag", "speed:=2.0"], "recorder has no parameter speed; it has directory,"),
    ],
)
def test_recorder_refuses(
    processes: Any, tmp_path: Path, monkeypatch: Any, arguments: list[str], reason: str
) -> None:
    """With the reason in one line, and without a bag."""
    monkeypatch.chdir(tmp_path)
    options = [part for argument in arguments for part in ("-p", argument)]
    command = executable("furuta_recordings", "recorder")
    process = processes.start(command, "--ros-args", *options)
    _, err = process.communicate(timeout=120.0)
    assert process.returncode == 1
    assert err.startswith(f"error: {reason}"), err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())
