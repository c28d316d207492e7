"""Records, identifies and compensates the elbow of the emulated robot, in seven minutes.

    tools/in_environment python examples/robot_joint/try.py output/elbow

The folder gets the bag and the joint file. If it has a joint file, that is used.
"""

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import sleep

from furuta_bringup.graph.processes import executable

HERE = Path(__file__).parent
PID = (60.0, 150.0, 5.0)
TRIED = "none", "coulomb", "stiction", "recommended"


@contextmanager
def running(*command: object) -> Iterator[subprocess.Popen[str]]:
    """Start a process, and interrupt it in the end if it still runs."""
    process = subprocess.Popen([*map(str, command)], text=True, stdout=subprocess.PIPE)
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.wait()


def controller(motion: str, seconds: float) -> list[object]:
    """The command that runs a motion."""
    ros = ["--ros-args", "-p", f"motion:={motion}", "-p", f"seconds:={seconds}"]
    return [sys.executable, HERE / "controller.py", *ros, "-p", f"pid:={list(PID)}"]


def observer(file: Path, compensation: str) -> list[object]:
    """The command of the elbow's friction observer."""
    names = ["__ns:=/elbow_joint", "joint_states:=/joint_states", "reference:=/reference"]
    ros = [part for name in names for part in ("-r", name)] + ["--params-file", file]
    ros += ["-p", f"compensation:={compensation}"]
    return [executable("furuta_friction", "friction_observer"), "--ros-args", *ros]


def identify(bag: Path, file: Path) -> None:
    """Record the rich motion, and write the joint file."""
    with running(*controller("excite", 65.0)):
        sleep(5.0)
        subprocess.run([sys.executable, HERE / "record.py", bag, "57"], check=True)
    verb = executable("furuta_bringup", "furuta")
    joint = ["--joint", "elbow_joint", "--write", file]
    subprocess.run([verb, "identify", "--body", "axis", bag, *joint], check=True)
    subprocess.run([verb, "axis", file, "--pid", *map(str, PID), "--write", file], check=True)


def compensate(file: Path) -> None:
    """Print how well the elbow follows with each compensation."""
    for motion, seconds in (("sine", 20.0), ("hold", 30.0)):
        control = controller(motion, seconds)
        for compensation in TRIED:
            with running(*observer(file, compensation)), running(*control) as process:
                out, _ = process.communicate()
            numbers = "  ".join(f"{name} {value:.4f}" for name, value in json.loads(out).items())
            print(f"{motion:5} {compensation:20} {numbers}", flush=True)


def main(folder: Path) -> None:
    """All steps with one robot."""
    with running(sys.executable, HERE / "robot.py"):
        if not (folder / "joint.yaml").exists():
            identify(folder / "bag", folder / "joint.yaml")
        compensate(folder / "joint.yaml")


with suppress(KeyboardInterrupt):
    main(Path(sys.argv[1]))
