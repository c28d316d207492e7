"""One recording as other tables: the same answer within its errors, or refused for the true reason.

Units and layouts are those of ``furuta_recordings/test_tables.py``, which need no fit.
"""

from collections.abc import Callable
from functools import cache
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import furuta
from furuta.results.identified import AxisFit
from furuta.results.servo_axes import AxisRun
from furuta.results.table import Table
from furuta_recordings.series_columns import COLUMNS

DT = 4e-3
TIME = DT * np.arange(2000)
TRUE = {"inertia": 0.01, "alpha0": 0.1, "viscous": 0.02, "offset": 0.0}
AXIS = furuta.Axis(0.01, furuta.Friction(alpha0=0.1, alpha1=0.0, viscous=0.02), "coulomb")
WAVES = 0.3 * np.sin(4.4 * TIME) + 0.1 * np.sin(11.9 * TIME)
MOVES = {
    "both ways": 2.0 * WAVES,
    "one way": 5.0 * TIME + WAVES,
    "to and fro": 0.4 * np.clip(3.0 * np.sin(1.3 * TIME), -1.0, 1.0),
}
COUNTS = (2**14, 2**20, 2**23, 0)
GRADES = ("no", "doubtful", "yes")
SLOW = [pytest.param(each, marks=pytest.mark.long) for each in MOVES]

Columns = dict[str, np.ndarray]


@cache
def run(moves: str, counts: int = 2**14) -> AxisRun:
    pid = furuta.Pid(4.0, 6.0, 0.2)
    return furuta.simulate_axis(AXIS, pid, reference=MOVES[moves], counts=counts, sample_time=DT)


def rows(columns: Columns, chosen: np.ndarray) -> Columns:
    return {name: values[chosen] for name, values in columns.items()}


def joined(*parts: Columns) -> Columns:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def mirrored(columns: Columns) -> Columns:
    return {name: values if name == "time" else -values for name, values in columns.items()}


def later(columns: Columns, seconds: float) -> Columns:
    return columns | {"time": columns["time"] + seconds}


def holes(columns: Columns, name: str, where: np.ndarray) -> Columns:
    return columns | {name: np.where(where, np.nan, columns[name])}


rng = np.random.default_rng(1)
CHANGES: dict[str, Callable[[Columns], Columns]] = {
    "mirrored": mirrored,
    "another clock": lambda c: later(c, 1.7e9),
    "turned position": lambda c: c | {"position": c["position"] + 100.0},
    "rows twice": lambda c: rows(c, np.repeat(np.arange(len(TIME)), 2)),
    "rows missing": lambda c: rows(c, rng.random(len(TIME)) < 0.95),
    "values missing": lambda c: holes(c, "position", rng.random(len(TIME)) < 0.02),
    "torque missing": lambda c: holes(c, "torque", (c["time"] > 4.0) & (c["time"] < 4.5)),
    "a gap": lambda c: rows(c, (c["time"] < 3.0) | (c["time"] > 5.0)),
    "half": lambda c: rows(c, c["time"] < 4.0),
    "rows turned": lambda c: rows(c, np.arange(len(TIME))[::-1]),
    "rows in disorder": lambda c: rows(c, rng.permutation(len(TIME))),
    "rounded stamps": lambda c: c | {"time": np.round(c["time"], 3)},
    "jittered stamps": lambda c: c | {"time": c["time"] + 0.05 * DT * rng.random(len(TIME))},
    "two runs": lambda c: joined(c, later(mirrored(c), 10.0)),
    "clock begins anew": lambda c: joined(c, c),
    "mirrored, clock begins anew": lambda c: joined(c, mirrored(c)),
    "short, clock begins anew": lambda c: joined(rows(c, c["time"] < 3.0), mirrored(c)),
    "three runs of which the clock begins anew": lambda c: joined(c, mirrored(c), later(c, 1.0)),
}


def identified(path: Path, columns: Columns) -> AxisFit | str:
    """The fit of a table, or why there is none, in a line."""
    Table(columns).write(path / "log.csv")
    try:
        return furuta.identify(furuta.read_axis(path / "log.csv"), "axis")
    except furuta.ParameterError as error:
        assert "\n" not in str(error)
        return str(error)


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Columns, AxisFit]]:
    @cache
    def columns_and_fit(moves: str) -> tuple[Columns, AxisFit]:
        moved = run(moves)
        columns = {"time": TIME, "position": moved.measured, "torque": moved.torque}
        fit = identified(tmp_path_factory.mktemp("usual"), columns)
        assert isinstance(fit, AxisFit)
        return columns, fit

    return columns_and_fit


@pytest.mark.parametrize("moves", ["both ways", *SLOW[1:]])
@pytest.mark.parametrize("change", CHANGES)
def test_another_table_gives_the_same(tmp_path: Path, usual: Any, moves: str, change: str) -> None:
    columns, one = usual(moves)
    other = identified(tmp_path, CHANGES[change](columns))
    if isinstance(other, str):
        assert change in ("rows turned", "rows in disorder")
        assert "sort them by time" in other
        return
    assert change != "half" or GRADES.index(other.usable) <= GRADES.index(one.usable)
    assert not ("clock" in change and any("dropout" in text for text in other.findings))
    for name in set(one.values) & set(other.values) & TRUE.keys() - {"offset"}:
        errors = hypot(*(each.standard_errors.get(name, 0.0) for each in (one, other)))
        assert other.values[name] == pytest.approx(one.values[name], rel=1e-3, abs=4.0 * errors)


@pytest.mark.parametrize("moves", [*SLOW[:1], "one way", *SLOW[2:]])
def test_a_finer_encoder_is_no_worse(moves: str) -> None:
    """Its values are as near to the truth as it says, and it determines no less."""
    before = None
    for counts in COUNTS:
        fit = furuta.identify(run(moves, counts).recording, "axis")
        for name in fit.values.keys() & TRUE.keys():
            error = 4.0 * fit.standard_errors.get(name, 0.0) + 1e-3 * TRUE[name] + 1e-6
            assert abs(fit.values[name] - TRUE[name]) < error, (counts, name)
        if before is not None:
            assert GRADES.index(fit.usable) >= GRADES.index(before.usable), (counts, fit.reasons)
            assert before.values.keys() & TRUE.keys() <= fit.values.keys(), counts
        before = fit


@pytest.fixture(scope="module")
def rig() -> Columns:
    series = furuta.simulate(seconds=4.0).series()
    return {
        "time": series["time_s"],
        "arm": series["measured_phi_rad"],
        "pendulum": series["measured_theta_rad"],
        "command": series["command_v"],
    }


@pytest.mark.parametrize("known", [name for name in COLUMNS if name != "time_s"])
def test_columns_of_another_rig_are_kept(tmp_path: Path, rig: Columns, known: str) -> None:
    """Also if one has a name of ours."""
    own = {"time_s": rig["time"], "foo": rig["arm"], "bar": rig["pendulum"], "u": rig["command"]}
    Table(own | {known: 2.0 * rig["arm"]}).write(tmp_path / "log.csv")
    command = known if known.endswith("_v") else "u"
    found = furuta.load_series(tmp_path / "log.csv", arm="foo", pendulum="bar", command=command)
    np.testing.assert_array_equal(found["measured_phi_rad"], own["foo"])
    np.testing.assert_array_equal(found["measured_theta_rad"], own["bar"])
    driven = 2.0 * own["foo"] if command == known else own["u"]
    np.testing.assert_array_equal(found["command_v"], driven)


@pytest.mark.parametrize("change", [name for name in CHANGES if "clock" in name])
def test_each_row_keeps_its_command(tmp_path: Path, rig: Columns, change: str) -> None:
    both = CHANGES[change](rig)
    Table(both).write(tmp_path / "log.csv")
    found = furuta.load_series(tmp_path / "log.csv")
    np.testing.assert_array_equal(found["command_v"], both["command"])
    assert np.all(np.diff(found["time_s"]) > 0.0)
