"""Recording, replaying and identifying on the command line."""

from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from furuta_recordings.series_columns import COLUMNS
from furuta_ros.node import deep
from furuta_ros.topics import JOINT_STATES, MEASUREMENT


@pytest.fixture(scope="module")
def bag(tmp_path_factory: Any) -> Path:
    return Path(tmp_path_factory.mktemp("bags")) / "bag"


@pytest.fixture(autouse=True)
def recorded(furuta: Any, bag: Path) -> None:
    """Record the lock-step bag that the tests of this file share."""
    if not bag.exists():
        status, _, err = furuta(
            "run", "--lockstep", "--seconds", "2", "--record", bag, "--set", "compensation=lugre"
        )
        assert status == 0, err


def test_info(answer: Any, bag: Path) -> None:
    """Messages, topics, types and the parameter file of a bag."""
    result = answer("bag", "info", bag)
    assert result["messages"] == 10_002  # active_mode: off, then balance
    assert result["topics"]["/command"] == {"type": "std_msgs/msg/Float64", "messages": 2000}
    assert Path(result["parameters"]).is_file()


def test_export_as_table(answer: Any, bag: Path, tmp_path: Path) -> None:
    """A row per measurement, every column of the graph, each sample with its own command."""
    table = tmp_path / "bag.csv"
    result = answer("bag", "export", bag, "--out", table)
    assert result["rows"] == 2000
    header = table.read_text().splitlines()[0].split(",")
    assert header == result["columns"]
    # The paper's rig measures no pendulum speed.
    assert set(COLUMNS) - set(header) == {"measured_theta_dot_rad_s"}
    rows = dict(zip(header, np.loadtxt(table, delimiter=",", skiprows=1).T, strict=True))
    assert rows["time_s"] == pytest.approx(np.arange(2000) * 1e-3)
    # The torque applied in a sample is its command, rounded by the drive's 12 bits of ±10 V.
    error = rows["applied_torque_v"][1:] - rows["command_v"][:-1]
    assert np.max(np.abs(error)) < 20 / 2**12
    assert np.max(np.abs(rows["true_phi_rad"] - rows["estimated_phi_rad"])) < 0.05


def test_replay_of_chosen_and_renamed_topics(bench: Any, processes: Any, bag: Path) -> None:
    """Only the chosen topics, one under another name, in order and not too fast."""
    renamed: list[Any] = []
    bench.probe.create_subscription(JOINT_STATES.message, "renamed", renamed.append, deep(10_000))
    kept = bench.collect(MEASUREMENT)
    command = ("bag", "replay", bag, "--topic", "measurement", "--topic", "joint_states")
    start = monotonic()
    process = processes.furuta(
        *command, "--remap", "joint_states:=renamed", "--wait", "--rate", "4"
    )
    bench.spin(lambda: len(kept) == 2000 and len(renamed) == 2000, 60.0)
    out, err = process.communicate(timeout=120.0)
    assert process.returncode == 0, err
    assert out.split()[:2] == ["published", "4000"]
    assert monotonic() - start > 2.0 / 4
    stamps = [m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec for m in renamed]
    assert stamps == sorted(stamps)


def test_identify_from_a_table(furuta: Any, answer: Any, tmp_path: Path) -> None:
    """A table with other names, a hanging zero, and commands in separate rows."""
    series = tmp_path / "run.npz"
    furuta("simulate", "--ideal-sensors", "--seconds", "3", "--out", series)
    table = tmp_path / "log.csv"
    joints = [
        f"/js/{joint}/{part}" for joint in ("rotor", "link") for part in ("position", "velocity")
    ]
    lines = [",".join(["__time", *joints, "/drive/data.0"])]
    with np.load(series) as file:
        states = file["estimate"][:, :4].tolist()
        for t, (phi, v, theta, w), u in zip(file["time"], states, file["command"], strict=True):
            lines += [f"{t},{phi},{v},{np.pi - theta},{-w},", f"{t},,,,,{u}"]
    table.write_text("\n".join(lines) + "\n")
    file_out = tmp_path / "rig.yaml"
    names = ("--arm", "rotor", "--pendulum", "link", "--command", "/drive", "--zero", "hanging")
    picture = tmp_path / "model.png"
    written = ("--write", file_out, "--figure", picture)
    result = answer("identify", table, *names, *written, "--laws")
    assert result["a43"] == pytest.approx(33, rel=0.05)
    assert result["coulomb"] == pytest.approx(0.21, rel=0.05)
    assert result["fit"]["log.csv"]["arm_speed"] > 90
    errors = {each["law"]: each["errors"]["second half"] for each in result["friction_laws"]}
    assert errors["coulomb"] == 1.0 < errors["viscous"]
    assert result["simplest_adequate_law"] in errors
    assert picture.stat().st_size > 10_000
    assert (result["usable"], result["figure"]) == ("yes", str(picture))
    status, _, err = furuta("simulate", "--seconds", "1", "--params", file_out)
    assert status == 0, err


def test_an_unusable_model_is_not_written(furuta: Any, tmp_path: Path) -> None:
    """Here the commands are in disorder."""
    series, table, rig = (tmp_path / name for name in ("run.npz", "log.csv", "rig.yaml"))
    furuta("simulate", "--ideal-sensors", "--seconds", "2", "--out", series)
    with np.load(series) as file:
        commands = np.random.default_rng(1).permutation(file["command"])
        columns = [file["time"], *file["estimate"].T[[0, 2]], commands]
    np.savetxt(table, np.column_stack(columns), header="time,arm,pendulum,command", delimiter=",",
        comments="")  # fmt: skip
    status, out, err = furuta("identify", table, "--write", rig)
    assert (status, rig.exists()) == (1, False)
    assert "The model is not usable: log.csv: fit of the" in out
    assert "error: not usable: log.csv: fit of the arm" in err


def written(path: Path, topic: str, data: bytes) -> Path:
    """A bag with one message."""
    types = get_typestore(Stores.ROS2_JAZZY)
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(topic, "std_msgs/msg/Float64", typestore=types)
        writer.write(connection, 0, data)
    return path


def test_names_in_files_do_not_command_the_terminal(furuta: Any, tmp_path: Path) -> None:
    """They are printed with escapes."""
    status, out, err = furuta("bag", "info", written(tmp_path / "bag", "/x\x1b[2J\ny", bytes(12)))
    assert status == 0, err
    assert "\x1b[2J" not in out + err
    assert "/x\\x1b[2J\\ny" in out + err


def test_a_message_of_another_type_is_not_replayed(furuta: Any, tmp_path: Path) -> None:
    """One line names its topic, or one that is not there."""
    bag = written(tmp_path / "bag", "/command", bytes(1000))  # more than a Float64 has
    for options, reason in ((), "cannot replay /command: "), (("--topic", "x"), "has no topic /x"):
        status, _, err = furuta("bag", "replay", "--rate", "0", bag, *options)
        assert (status, len(err.splitlines())) == (1, 1), err
        assert reason in err
