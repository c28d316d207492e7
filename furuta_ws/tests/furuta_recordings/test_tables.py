"""CSV tables of every make: separators, marks, dates, units, names and times of the columns."""

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from furuta_model.parameters import ParameterError
from furuta_recordings.cleaning import cleaned
from furuta_recordings.readers import Mapping, read
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import excerpts_of

TIME = np.arange(200) * 0.005
STATE = np.column_stack((np.sin(TIME), np.cos(TIME), 0.5 * np.sin(2 * TIME), np.cos(2 * TIME)))
VOLTS = np.where(TIME < 0.5, 1.0, -1.0)
HEADER = "time,arm/position,arm/velocity,pendulum/position,pendulum/velocity,command"
NO_NAMES = Mapping()


def table(header: str = HEADER, scales: tuple[float, ...] = (1.0,) * 6) -> str:
    """The series as a table, each column divided by the size of its unit."""
    rows = np.column_stack((TIME, STATE, VOLTS)) / np.array(scales)
    return "\n".join([header, *(",".join(f"{x:.9f}" for x in row) for row in rows)]) + "\n"


def recording_of(path: Path, text: str | bytes, mapping: Mapping = NO_NAMES) -> Recording:
    file = path / "log.csv"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read(file, mapping)


def assert_same(found: Recording) -> None:
    """The recording holds the series in SI units."""
    np.testing.assert_allclose(found.time, TIME, atol=2e-6)
    np.testing.assert_allclose(found.measured, STATE, atol=1e-7)
    np.testing.assert_allclose(found.command, VOLTS)


def dated(start: str) -> str:
    """The table with dates instead of seconds."""
    first = datetime.fromisoformat(start)
    lines = table().splitlines()
    rows = [line.split(",", 1)[1] for line in lines[1:]]
    dates = [(first + timedelta(seconds=float(t))).isoformat() for t in TIME]
    return "\n".join([lines[0], *(f"{d},{row}" for d, row in zip(dates, rows, strict=True))])


@pytest.mark.parametrize(
    "text",
    [
        table(),
        "\ufeff" + table(),
        table().replace("\n", "\r\n"),
        table().replace(",", ";"),
        table().replace(",", ";").replace(".", ","),
        table().replace(",", "\t").replace(".", ","),
        table().replace(",", "  "),
        "# made by a logger\n\n" + table(),
        dated("2026-01-31T23:59:59.700"),
        dated("2026-01-31T23:59:59.700+02:00").replace("T", " "),
    ],
    ids=[
        "plain", "mark", "line ends", "semicolons", "decimal commas", "tabs", "blanks",
        "comments", "dates", "dates with a zone",
    ],
)  # fmt: skip
def test_a_table_of_any_make(tmp_path: Path, text: str | bytes) -> None:
    assert_same(recording_of(tmp_path, text))


DEG, RPM = np.pi / 180.0, 2.0 * np.pi / 60.0


@pytest.mark.parametrize(
    ("header", "scales", "mapping"),
    [
        (
            "Time [ms],Arm Angle [deg],Arm Speed [rpm],Pendulum Angle [rad],"
            "Pendulum Speed (deg/s),Voltage [mV]",
            (1e-3, DEG, RPM, 1.0, DEG, 1e-3),
            NO_NAMES,
        ),
        (
            "micros,motor arm position_deg,motor arm speed_rpm,pole_angle_rad,pole_angle_dot,u",
            (1e-6, DEG, RPM, 1.0, 1.0, 1.0),
            Mapping("motor arm", "pole"),
        ),
        (
            "t (s),phi,phi dot,theta [°],theta dot [°/s],Motor Voltage [V]",
            (1.0, 1.0, 1.0, DEG, DEG, 1.0),
            Mapping("phi", "theta", "Motor Voltage"),
        ),
    ],
)
def test_units_and_names(
    tmp_path: Path, header: str, scales: tuple[float, ...], mapping: Mapping
) -> None:
    """Units in brackets or at the end of a name; names of several words."""
    assert_same(recording_of(tmp_path, table(header, scales), mapping))


def test_named_units_count(tmp_path: Path) -> None:
    """Angles whose unit the table names need no detection."""
    named = table(HEADER.replace("position", "position_rad"))
    assert recording_of(tmp_path, named).in_radians
    assert not recording_of(tmp_path, table()).in_radians


@pytest.mark.parametrize("ending", ["stamp", "stamp.sec", "secs"])
def test_the_stamp_of_the_states(tmp_path: Path, ending: str) -> None:
    """Of several stamps the one of the joint states; also in seconds and nanoseconds."""
    start = 1_700_000_000
    lines = []
    for t, x, u in zip(TIME, STATE, VOLTS, strict=True):
        whole, nano = int(start + t), round((start + t) % 1.0 * 1e9)
        own = {"stamp": f"{start + t:.9f}", "stamp.sec": f"{whole},{nano}", "secs": ""}[ending]
        state = ",".join(f"{value:.9f}" for value in x)
        lines.append(f"{start + t + 0.001 * np.sin(t):.9f},{start - 5.0 + t},{own},{state},{u}")
    head = {
        "stamp": "/js/header/stamp",
        "stamp.sec": "/js/header/stamp/sec,/js/header/stamp/nanosec",
        "secs": "unused",
    }[ending]
    header = (
        f"__time,/drive/header/stamp,{head},/js/arm/position,/js/arm/velocity,"
        "/js/pendulum/position,/js/pendulum/velocity,/drive/command"
    )
    found = recording_of(tmp_path, "\n".join([header, *lines]))
    if ending == "secs":  # only the stamp of another message: the time of the row counts
        assert np.max(np.abs(found.time - TIME)) == pytest.approx(8e-4, abs=1e-4)
    else:
        np.testing.assert_allclose(found.time, TIME, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (table().replace("time", "when"), "name it with --time"),
        (table("t,a,b,c,d,e"), "name the joints with --arm and --pendulum"),
        (table(scales=(1e-3, 1, 1, 1, 1, 1)), "add its unit to the name, as in time_ms"),
        (table().replace("position", "position [furlong]"), "is not one of rad"),
        (table().replace("time", "time [parsec]"), "is not one of s, "),
        (table().replace(".", ","), "separate cells by semicolons"),
        (table().replace("command", "torque"), "name its column with --command"),
        ("time,a\n", "no table in it"),
        (bytes(range(128, 256)), "not a text file"),
        (b"time,a\n" + b"1," * 2**20, "a line has more than 1048576 characters"),
    ],
)
def test_what_cannot_be_read_says_what_to_do(tmp_path: Path, text: str | bytes, words: str) -> None:
    with pytest.raises(ParameterError, match=words) as caught:
        recording_of(tmp_path, text)
    assert "\n" not in str(caught.value)


def test_a_named_time_column(tmp_path: Path) -> None:
    text = table().replace("time", "when [s]")
    assert_same(recording_of(tmp_path, text, Mapping(time="when")))


def test_times_that_decrease_or_repeat(tmp_path: Path) -> None:
    """Repeated rows are dropped, rows in the wrong order refused."""
    lines = table().splitlines()
    twice = [lines[0], *(line for line in lines[1:] for _ in range(2))]
    found = cleaned(recording_of(tmp_path, "\n".join(twice)))
    np.testing.assert_allclose(found.time, TIME, atol=1e-9)
    assert "200 of 400 samples dropped" in found.findings[-1]
    backward = [lines[0], *reversed(lines[1:])]
    with pytest.raises(ParameterError, match="sort them by time"):
        cleaned(recording_of(tmp_path, "\n".join(backward)))


EXPORTED = (
    "time_s,measured_phi_rad,measured_phi_dot_rad_s,measured_theta_rad,estimated_phi_rad,command_v"
)


def test_exported_series_give_their_measurements(tmp_path: Path) -> None:
    """Not their estimates; a speed without a sensor is missing."""
    rows = np.column_stack((TIME, STATE[:, :3], STATE[:, 0] + 1.0, VOLTS))
    lines = [EXPORTED, *(",".join(map(repr, row.tolist())) for row in rows)]
    found = recording_of(tmp_path, "\n".join(lines) + "\n")
    np.testing.assert_array_equal(found.measured[:, :3], STATE[:, :3])
    assert np.all(np.isnan(found.measured[:, 3]))
    np.testing.assert_array_equal(found.command, VOLTS)
    assert found.in_radians


def test_estimates_are_no_measurements(tmp_path: Path) -> None:
    """An exported series without measurements is refused, unless its columns are named."""
    text = table("time_s,estimated_phi_rad,estimated_phi_dot_rad_s,true_theta_rad,w,command_v")
    with pytest.raises(ParameterError, match="it takes no estimates for measurements"):
        recording_of(tmp_path, text)
    names = Mapping("estimated_phi_rad", "true_theta_rad", "command_v")
    np.testing.assert_allclose(recording_of(tmp_path, text, names).measured[:, 0], STATE[:, 0])


def test_simulations_without_measurements_are_refused(tmp_path: Path) -> None:
    """Files of earlier versions hold estimates only."""
    file = tmp_path / "run.npz"
    np.savez(file, time=TIME, estimate=STATE, command=VOLTS)
    with pytest.raises(ParameterError, match="has no time, measurement or command"):
        read(file, NO_NAMES)


@pytest.mark.parametrize("step", [5e-324, 1e-323, 1e-300, 1e-20, 1e-9])
def test_times_too_close_to_be_samples_are_refused(tmp_path: Path, step: float) -> None:
    """Unless they are few: then they are dropped."""
    close = np.arange(200) * step
    with pytest.raises(ParameterError, match=r"200 times over .* correct the times"):
        recording_of(tmp_path, timed(close))
    few = recording_of(tmp_path, timed(np.where(TIME < 0.25, close, TIME)))
    assert np.min(np.diff(cleaned(few).time)) > 1e-9


def timed(times: np.ndarray) -> str:
    """A table with these times."""
    rows = (f"{time!r},0.1,0.2,0.3" for time in times.tolist())
    return "\n".join(["time_s,arm,pendulum,command", *rows])


def test_times_over_more_than_a_log_can_last_are_refused(tmp_path: Path) -> None:
    text = table().replace("\n", "\n1e300,0,0,0,0,0\n", 1)
    with pytest.raises(ParameterError, match=r"201 times over 1e\+300 s"):
        recording_of(tmp_path, text)


@pytest.mark.parametrize("step", [0.0, 1e-7])
def test_a_dense_recording_is_one_excerpt(step: float) -> None:
    """It is shorter than the usual excerpt, and its times may stand still."""
    time = np.arange(200) * step
    dense = Recording("log", time, STATE, time, VOLTS)
    assert len(excerpts_of(dense, most_samples=100)) == 1
