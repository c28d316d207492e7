"""CSV tables of every make: separators, marks, dates, units, names and times of the columns."""

from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from furuta_model.parameters import ParameterError
from furuta_recordings.cleaning import cleaned
from furuta_recordings.csv_columns import DATE, DAY_TIME, HOUR_TIME, INSTANT
from furuta_recordings.readers import Mapping, read, read_axis
from furuta_recordings.readers.columns import (
    ANGLE_UNITS,
    AXIS_UNITS,
    COMMAND_UNITS,
    DRIVE_UNITS,
    POSITION_UNITS,
    SPEED_UNITS,
    TIME_UNITS,
)
from furuta_recordings.recording import Recording

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
        table().replace(",", ";").replace(".", ","),
        "sep=;\n" + table().replace(",", ";").replace(".", ","),
        table().replace(",", "\t").replace(".", ",").encode("utf-16"),
        "\n".join('"' + line.replace(",", '","') + '"' for line in table().splitlines()),
        "# " + table(),
        table().replace("\n", "\ns,rad,rad/s,rad,rad/s,V\n", 1),
        table() + ",,,,,\n\n" + table().splitlines()[0] + "\n",
        dated("2026-01-31T23:59:59.700+02:00").replace("T", " "),
        "Axis 1\nSamples,8000\nInterval (ms),1.000\n" + table(),
        "Export\n\n" + table().replace("\n", "\ns,rad,rad/s,rad,rad/s,V\n", 1),
    ],
    ids=[
        *("plain", "decimal commas", "separator named", "UTF-16", "quoted", "header in a comment"),
        *("units below", "blank rows and another header", "dates with a zone"),
        *("lines above the header", "lines and units above the numbers"),
    ],
)
def test_a_table_of_any_make(tmp_path: Path, text: str | bytes) -> None:
    assert_same(recording_of(tmp_path, text))


UNITS = {
    "time": TIME_UNITS,
    "arm/position": ANGLE_UNITS,
    "arm/velocity": SPEED_UNITS,
    "pendulum/position": ANGLE_UNITS,
    "command": COMMAND_UNITS,
}
# Units of a time that are names of forms, such as a date.
FORMS = {DATE, DAY_TIME, HOUR_TIME, INSTANT}


@pytest.mark.parametrize(
    ("name", "unit"), [(name, u) for name, units in UNITS.items() for u in units if u not in FORMS]
)
def test_every_unit(tmp_path: Path, name: str, unit: str) -> None:
    """In brackets, in capitals, at the end of a name and below it, with the columns turned."""
    names = HEADER.split(",")
    scales = tuple(UNITS[name][unit] if each == name else 1.0 for each in names)
    headers = [f"{name} [{unit}]", f"{name.upper()} ({unit.upper()})"]
    if unit[0].isalpha():
        headers.append(f"{name}_{unit.replace('/', '_per_')}")
    for header in headers:
        lines = table(HEADER.replace(name, header), scales).splitlines()
        turned = "\n".join(",".join(line.split(",")[::-1]) for line in lines)
        assert_same(recording_of(tmp_path, turned))
    below = ",".join(unit if each == name else "" for each in names)
    assert_same(recording_of(tmp_path, table(f"{HEADER}\n{below}", scales)))


@pytest.mark.parametrize("drive", DRIVE_UNITS)
@pytest.mark.parametrize("unit", POSITION_UNITS)
def test_every_unit_of_an_axis(tmp_path: Path, unit: str, drive: str) -> None:
    """A torque acts on a length through a lead, a force on an angle through a radius."""
    of, acts = AXIS_UNITS[unit], AXIS_UNITS[drive]
    lead = 0.01 if (of, acts) == ("m", "N m") else 0.0
    radius = 2.0 if (of, acts) == ("rad", "N") else 1.0
    header, columns = f"time,position [{unit}],torque [{drive}]", (TIME, STATE[:, 0], VOLTS)
    found = axis_of(tmp_path, columns, header, lead=lead, torque_constant=radius)
    size = POSITION_UNITS[unit] * (2.0 * np.pi / lead if lead else 1.0)
    assert found.position_unit == (unit, pytest.approx(size))
    np.testing.assert_allclose(found.measured[:, 0], size * STATE[:, 0])
    np.testing.assert_allclose(found.command, radius * DRIVE_UNITS[drive] * VOLTS)


def test_names_of_several_words(tmp_path: Path) -> None:
    header = "micros,motor arm position_deg,motor arm speed_rpm,pole_angle_rad,pole_angle_dot,u"
    scales = (1e-6, np.pi / 180.0, 2.0 * np.pi / 60.0, 1.0, 1.0, 1.0)
    assert_same(recording_of(tmp_path, table(header, scales), Mapping("motor arm", "pole")))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (table("t,a,b,c,d,e"), "name the joints with --arm and --pendulum"),
        (table(scales=(1e-3, 1, 1, 1, 1, 1)), "add its unit to the name, as in time_ms"),
        (table().replace("position", "position [furlong]"), "is not one of rad"),
        (table().replace(".", ","), "separate cells by semicolons"),
        (
            table().replace("arm/velocity", "battery_voltage").replace("command", "motor_voltage"),
            "any of battery_voltage, motor_voltage may be the command; name it with --command",
        ),
        (table().split("\n", 1)[1], "line 1 holds numbers, where the names"),
        (table().replace("arm/velocity", "command"), "command is there twice, with different"),
        (
            table().replace("1.000000000\n", "abc\n"),
            "200 cells in column command are not numbers, first 'abc' in line 2",
        ),
        (b"PK\x03\x04" + bytes(30), "a zip archive or workbook"),
        (b"\x89PNG\r\n\x1a\n\0", "it is a picture"),
        ("just,words\nand,more\n", "no row of numbers"),
    ],
)
def test_what_cannot_be_read_says_what_to_do(tmp_path: Path, text: str | bytes, words: str) -> None:
    with pytest.raises(ParameterError, match=words) as caught:
        recording_of(tmp_path, text)
    assert "\n" not in str(caught.value)


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


AXIS = "time,position_rad,torque"
# Encoder counts of a motion through several turns of 1000 counts.
COUNTS = np.round(3000.0 * np.sin(4.0 * TIME)).astype(int)


def axis_of(
    path: Path, columns: tuple[Any, ...], header: str = AXIS, sep: str = ",", **units: float
) -> Recording:
    """The recording of an axis from these columns of text."""
    rows = (sep.join(map(str, row)) for row in zip(*columns, strict=True))
    file = path / "axis.csv"
    file.write_text("\n".join([header.replace(",", sep), *rows]))
    return read_axis(str(file), "counts" if ",counts," in header else None, **units)


def test_what_stands_between_names_and_numbers_is_told(tmp_path: Path) -> None:
    """Of an export that describes its columns in many lines nothing is guessed."""
    text = "Name,Axis test\nName,Pos,Torque\nType,REAL,REAL\nOffset,0,0\n0,0.1,0.2\n1,0.2,0.3\n"
    (tmp_path / "log.csv").write_text(text.replace("Offset", "Unit offset"))
    with pytest.raises(ParameterError, match="line 5: leave one line above them"):
        read_axis(tmp_path / "log.csv")


def test_a_second_name_below_is_no_unit(tmp_path: Path) -> None:
    rows = [f"{1e3 * t:.3f},{x},{u}" for t, x, u in zip(TIME, STATE[:, 0], VOLTS, strict=True)]
    names = ["Drive 7", "Time,Analog 1,Analog 2", "ms,Position,Torque"]
    (tmp_path / "log.csv").write_text("\n".join([*names, *rows]))
    found = read_axis(tmp_path / "log.csv", position="Analog 1", command="Analog 2")
    np.testing.assert_allclose(found.time, TIME, atol=1e-6)
    np.testing.assert_allclose(found.command, VOLTS)


def times_as(form: str) -> list[str]:
    """The times as a logger writes them that was started before midnight."""
    start = datetime(2026, 1, 31, 23, 59, 59, 600_000)
    stamps = [start + timedelta(seconds=float(t)) for t in TIME]
    return [
        stamp.strftime(form.replace("%f", f"{stamp.microsecond // 1000:03d}")) for stamp in stamps
    ]


@pytest.mark.parametrize(
    ("form", "header"),
    [
        ('"%Y-%m-%d %H:%M:%S,%f"', AXIS),
        ("%d.%m.%Y %H:%M:%S.%f", AXIS),
        ("%Y/%m/%d %I:%M:%S.%f %p", AXIS),
        ("%H:%M:%S.%f", AXIS),
        ("%Y-%m-%d,%H:%M:%S.%f", "date,time,position_rad,torque"),
    ],
)
def test_forms_of_time(tmp_path: Path, form: str, header: str) -> None:
    """Dates, times of day past midnight, and both in two columns."""
    found = axis_of(tmp_path, (times_as(form), STATE[:, 0], VOLTS), header)
    np.testing.assert_allclose(found.time, TIME, atol=1e-6)


@pytest.mark.parametrize(
    ("name", "unit", "size", "start"),
    [
        ("micros", 1e-6, 2**32, 2**32 - 400_000),
        ("time_ms", 1e-3, 2**16, 2**16 - 400),
    ],
)
def test_counters_of_time_overflow(
    tmp_path: Path, name: str, unit: float, size: int, start: int
) -> None:
    times = (np.round(TIME / unit).astype(int) + start) % size
    found = axis_of(tmp_path, (times, STATE[:, 0], VOLTS), f"{name},position_rad,torque")
    np.testing.assert_allclose(found.time, TIME, atol=1e-9)
    assert f"column {name} begins anew after every {size}" in found.findings[0]


@pytest.mark.parametrize(
    ("header", "values", "unit"),
    [
        ("time,position_rad,torque", (COUNTS * 0.002 + np.pi) % (2 * np.pi) - np.pi, 500.0),
        ("time,position [deg],torque", (COUNTS * 0.2) % 360, 900.0 / np.pi),
        ("time,counts,torque", COUNTS % 1000, 1.0),
        ("time,counts,torque", (COUNTS * 20 + 2**15) % 2**16 - 2**15, 0.05),
    ],
)
def test_positions_begin_anew(tmp_path: Path, header: str, values: Any, unit: float) -> None:
    """Angles after a turn, counts of one turn, and counters that overflow."""
    found = axis_of(tmp_path, (TIME, values, VOLTS), header)
    travelled = unit * found.measured[:, 0]
    np.testing.assert_allclose(travelled - travelled[0], COUNTS - COUNTS[0], atol=1e-6)
    assert "begins anew after" in found.findings[-1]


GERMAN = [f"{t:.3f}".replace(".", ",") for t in TIME]
FALLING = [f"{1.5 - t:.3f}".replace(".", ",") for t in TIME]
GROUPED = [f"{count:,}" for count in COUNTS]


@pytest.mark.parametrize(
    ("times", "counts", "sep", "words"),
    [
        (TIME, [f'"{text}"' for text in GROUPED], ",", "may be a thousand"),
        (GERMAN, [text.replace(",", ".") for text in GROUPED], ";", "has decimal points, but"),
        (GERMAN, FALLING, ";", ""),
        (GERMAN, ["0,5", *map(str, TIME[1:])], ";", "has decimal points, but"),
    ],
)
def test_thousands_are_not_guessed(
    tmp_path: Path, times: Any, counts: Any, sep: str, words: str
) -> None:
    """Decimal commas are read where they are certain."""
    header = "time,counts,torque"
    columns = times, counts, np.where(TIME < 0.5, 1, -1)
    if words:
        with pytest.raises(ParameterError, match=words):
            axis_of(tmp_path, columns, header, sep)
    else:
        found = axis_of(tmp_path, columns, header, sep)
        np.testing.assert_allclose(found.measured[:, 0], 1.5 - TIME)


def test_rows_of_two_loggers(tmp_path: Path) -> None:
    """Rows with a position only, rows with a torque only, repeated ones and missing values."""
    rows = [
        f"{t:.4f},{x:.9f},\n{t + 0.001:.4f},,{u}"
        for t, x, u in zip(TIME, STATE[:, 0], VOLTS, strict=True)
    ]
    rows[7] = f"{TIME[7]:.4f},nan,1\n{TIME[6]:.4f},n/a,1"
    rows[9] += f"\n{TIME[9]:.4f},0,"
    file = tmp_path / "log.csv"
    file.write_text("\n".join([AXIS, *rows]))
    found = read_axis(file)
    np.testing.assert_allclose(found.measured[:, 0], np.delete(STATE[:, 0], 7), atol=1e-9)
    assert len(found.command) == 201
    assert "not later" in found.findings[-1]
    assert len(cleaned(found, joints=(0,)).time) == 199


def test_a_pendulum_alone_that_swings_freely(tmp_path: Path) -> None:
    """Its arm is taken to be at rest."""
    text = "\n".join(["Time,angle", *(f"{t},{x}" for t, x in zip(TIME, STATE[:, 2], strict=True))])
    for names in (Mapping(command="none"), Mapping(pendulum="angle", command="none")):
        found = recording_of(tmp_path, text, names)
        np.testing.assert_allclose(found.measured[:, 2], STATE[:, 2])
        assert np.all(found.measured[:, 0] == 0.0)
        assert any("arm: taken to be at rest" in finding for finding in found.findings)
    with pytest.raises(ParameterError, match="name the joints"):
        recording_of(tmp_path, text)


def test_matlab_and_numpy_files(tmp_path: Path) -> None:
    """Variables, a struct, a matrix with names; for a pendulum and for an axis."""
    names = HEADER.split(",")
    plain = dict(zip((n.replace("/", "_") for n in names), table_columns(), strict=True))
    matrix = {"data": np.column_stack(table_columns()), "names": np.array(names, object)}
    savemat(tmp_path / "plain.mat", plain | {"rate": 200.0, "about": "a log"})
    savemat(tmp_path / "struct.mat", {"log": plain})
    savemat(tmp_path / "matrix.mat", matrix)
    np.savez(tmp_path / "plain.npz", **plain)
    for file in ("plain.mat", "struct.mat", "matrix.mat", "plain.npz"):
        assert_same(read(tmp_path / file, NO_NAMES))
        found = read_axis(tmp_path / file, joint="pendulum")
        np.testing.assert_allclose(found.measured[:, 0], STATE[:, 2])
    savemat(tmp_path / "bare.mat", {"data": matrix["data"]})
    savemat(tmp_path / "short.mat", plain | {"command": VOLTS[1:]})
    for file, words in (
        ("bare", r"\(200 x 6\) without names"),
        ("short", "has 199 values, others"),
    ):
        with pytest.raises(ParameterError, match=words):
            read(tmp_path / f"{file}.mat", NO_NAMES)


def test_structs_that_share_a_field_keep_their_names(tmp_path: Path) -> None:
    """Positions of one are not taken with the torque of another; its time belongs to it."""
    file = tmp_path / "two.mat"
    measured = {"time": TIME, "position": STATE[:, 0], "torque": VOLTS}
    savemat(file, {"measured": measured, "planned": {"time": TIME, "position": 2.0 * STATE[:, 0]}})
    with pytest.raises(ParameterError, match=r"measured\.position, planned\.position"):
        read_axis(file)
    found = read_axis(file, position="planned.position")
    np.testing.assert_allclose(found.measured[:, 0], 2.0 * STATE[:, 0])
    np.testing.assert_allclose(found.command, VOLTS)


def test_lists_in_parquet_are_read_by_element(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    rows = {"timestamp": TIME, "action": list(STATE), "torque": VOLTS}
    parquet.write_table(pyarrow.table(rows), tmp_path / "log.parquet")
    with pytest.raises(ParameterError, match=r"lists of 4; name an element, such as action\[0\]"):
        read_axis(tmp_path / "log.parquet", position="action")
    found = read_axis(tmp_path / "log.parquet", position="action[2]")
    np.testing.assert_allclose(found.measured[:, 0], STATE[:, 2])


@pytest.mark.parametrize("given", [None, "dt"])
def test_a_column_of_steps_is_summed(tmp_path: Path, given: str | None) -> None:
    rows = "\n".join(f"0.005,{x:.9f},{u}" for x, u in zip(STATE[:, 0], VOLTS, strict=True))
    (tmp_path / "log.csv").write_text(f"dt,position,torque\n{rows}\n")
    found = read_axis(tmp_path / "log.csv", time=given)
    np.testing.assert_allclose(found.time, TIME, atol=1e-9)
    assert any("since the row before: summed" in text for text in found.findings)


def test_angle_and_velocity_are_one_joint(tmp_path: Path) -> None:
    rows = (f"{t},{x:.9f},{v:.9f}" for t, (x, v) in zip(TIME, STATE[:, :2], strict=True))
    found = recording_of(
        tmp_path, "\n".join(["time,angle,velocity", *rows]), Mapping(command="none")
    )
    np.testing.assert_allclose(found.measured[:, 2:], STATE[:, :2])


def test_a_table_without_a_header(tmp_path: Path) -> None:
    """Its columns are named, its rate is given; what it has itself is not overruled."""
    file = tmp_path / "log.csv"
    file.write_text("\n".join(f"{x:.9f};{u}" for x, u in zip(STATE[:, 0], VOLTS, strict=True)))
    found = read_axis(file, columns="position, torque", rate=200.0)
    np.testing.assert_allclose(found.time, TIME)
    np.testing.assert_allclose(found.measured[:, 0], STATE[:, 0], atol=1e-8)
    for options, words in (
        ({}, "give them with --columns"),
        ({"columns": "position"}, "2 cells, --columns names 1"),
        ({"columns": "time,torque", "rate": 1.0}, "has a column time"),
    ):
        with pytest.raises(ParameterError, match=words):
            read_axis(file, **options)
    file.write_text(table())
    with pytest.raises(ParameterError, match="leave out --columns"):
        read(file, Mapping(columns=HEADER))


@pytest.mark.parametrize(
    ("unit", "size", "named"),
    [("mN", 1e-3, "N"), ("N-m", 1.0, "N m"), ("Ncm", 0.01, "N m"), ("kgf cm", 0.0980665, "N m")],
)
def test_units_of_drives(tmp_path: Path, unit: str, size: float, named: str) -> None:
    position = "position_mm" if named == "N" else "position"
    rows = "\n".join(f"{t},{x:.9f},{u}" for t, x, u in zip(TIME, STATE[:, 0], VOLTS, strict=True))
    (tmp_path / "log.csv").write_text(f"time,{position},torque [{unit}]\n{rows}\n")
    found = read_axis(tmp_path / "log.csv")
    assert found.units[1] == named
    np.testing.assert_allclose(found.command, size * VOLTS)


def table_columns() -> list[np.ndarray]:
    return [TIME, *STATE.T, VOLTS]
