"""The connection to a rig: batches, failing and silent lines, and loading of drivers."""

import sys
from functools import partialmethod
from queue import Empty, Queue
from threading import Event
from typing import Any

import pytest

from furuta_hw import drivers
from furuta_hw.bridge.guarded_rig import GuardedRig
from furuta_hw.connection import rig_connection
from furuta_hw.connection.rig_connection import MAX_BATCH, RigConnection
from furuta_hw.connection.rig_driver import LineStatistics, RigDriver, RigSample
from furuta_hw.drivers import find_driver
from furuta_hw.drivers.serial_protocol.driver import SerialProtocolDriver
from furuta_hw.errors import LineError, RigError
from furuta_hw.guard import Guard
from furuta_hw.rigs.rig import Rig, SafetyLimits
from furuta_model.accepted_parts import accept_parts
from furuta_model.parameters import ParameterError


class ScriptedDriver(RigDriver):
    """A driver whose data come from the test; it records its calls."""

    def __init__(self) -> None:
        super().__init__("nowhere", Rig())
        self.calls: list[str] = []
        self.data: Queue[Any] = Queue()
        self.failing = ""  # the call that fails

    def call(self, name: str) -> None:
        """Record a call, and fail if it is the one that fails."""
        self.calls.append(name)
        if name == self.failing:
            raise LineError(f"{name} failed")

    open, close = partialmethod(call, "open"), partialmethod(call, "close")
    arm, stop = partialmethod(call, "arm"), partialmethod(call, "stop")

    def drive(self, volts: float) -> None:
        """Drive."""
        self.call("drive")

    def read(self) -> Any:
        """Return what the test has put."""
        try:
            data = self.data.get(timeout=0.01)
        except Empty:
            return []
        if isinstance(data, LineError):
            raise data
        return data

    def decode(self, data: Any) -> list[RigSample]:
        """Make samples of their numbers."""
        return [RigSample(number, 0.0, 0.0, 0.0, 0.0, armed=False) for number in data]


class Line:
    """A connection to a scripted driver, with a clock that the test sets."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 100.0
        monkeypatch.setattr(rig_connection, "monotonic", lambda: self.now)
        self.driver = ScriptedDriver()
        self._arrived = Event()
        self.connection = RigConnection(self.driver, self._arrived.set)
        self.connection.open()

    def put(self, data: Any) -> None:
        """Put data on the line and wait until they have been read."""
        self._arrived.clear()
        self.driver.data.put(data)
        assert self._arrived.wait(10.0)

    def numbers(self) -> list[int]:
        """Numbers of the samples that the connection returns."""
        return [sample.number for sample in self.connection.samples()]


@pytest.fixture
def line(monkeypatch: pytest.MonkeyPatch) -> Any:
    line = Line(monkeypatch)
    yield line
    line.connection.close()


def test_samples_come_in_order(line: Line) -> None:
    """All of them, each once; of a large batch the newest, and the others are counted."""
    line.put([1, 2])
    line.put([3])
    assert line.numbers() == [1, 2, 3]
    assert line.numbers() == []
    line.put(range(MAX_BATCH + 5))
    assert line.numbers() == list(range(5, MAX_BATCH + 5))
    assert line.connection.skipped_samples == 5


def test_a_failed_line_is_reported_once_and_opened_again(line: Line) -> None:
    """Samples before the failure still come; the rig is stopped before the line is closed."""
    line.put([1])
    line.put(LineError("cable pulled"))
    assert line.numbers() == [1]
    with pytest.raises(LineError, match="cable pulled"):
        line.numbers()
    assert line.driver.calls == ["open", "stop", "close"]
    assert (line.connection.connected, line.connection.failure) == (False, "cable pulled")
    assert line.numbers() == []
    assert line.driver.calls == ["open", "stop", "close"]  # the next attempt is not due yet
    line.now += 1.1
    line.driver.failing = "open"
    assert line.numbers() == []
    assert line.connection.failure == "open failed"
    line.now += 1.1
    line.driver.failing = ""
    assert line.numbers() == []
    assert line.connection.connected
    line.put([7])
    assert line.numbers() == [7]


def test_a_silent_rig_is_restarted(line: Line) -> None:
    """After a second, and again after another; the default restart stops it and opens it again."""
    line.now += 0.9
    assert line.numbers() == []
    for _ in range(2):
        line.now += 1.1
        with pytest.raises(LineError, match="no sample for 1 s"):
            line.numbers()
        assert line.numbers() == []
    assert line.driver.calls == ["open", *["stop", "close", "open"] * 2]
    line.now += 1.1
    line.driver.failing = "open"
    with pytest.raises(LineError, match="open failed"):
        line.numbers()
    assert not line.connection.connected


def test_bad_frames_count_from_a_restart(line: Line, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a driver whose count begins again there are not fewer than none."""
    statistics = LineStatistics(corrupt=50)
    monkeypatch.setattr(line.driver, "statistics", lambda: statistics)
    assert line.connection.new_bad_frames() == 50
    line.now += 1.1
    statistics = LineStatistics()
    with pytest.raises(LineError):
        line.numbers()
    assert line.connection.new_bad_frames() == 0


def test_a_rig_is_not_armed_again_after_a_failure(line: Line) -> None:
    """The line recovers by itself; the rig stays at 0 V until it is armed by hand."""
    reasons: list[str] = []
    ages = SafetyLimits(command_age=10.0, estimate_age=10.0, measurement_age=10.0)
    guard = Guard(ages, 0.001)
    rig = GuardedRig(line.connection, guard, lambda: reasons.append(guard.reason))
    clock = rig.clock
    line.put([1])
    assert [sample.number for sample in rig.samples()] == [1]
    assert rig.arm() == ""
    line.put(LineError("cable pulled"))
    assert list(rig.samples()) == []
    assert (guard.armed, reasons, rig.clock is clock) == (False, ["cable pulled"], False)
    assert rig.arm() == "no line to the rig: cable pulled"
    line.now += 1.1
    assert list(rig.samples()) == []
    line.put([1])
    assert [sample.number for sample in rig.samples()] == [1]
    rig.command(1.0)
    assert not guard.armed
    assert line.driver.calls == ["open", "arm", "stop", "close", "open"]
    assert rig.arm() == ""


def test_drivers_are_found_by_name(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch, no_parts: None
) -> None:
    """A module of furuta_hw/drivers, or a class that the process accepts."""
    assert find_driver("serial_protocol") is SerialProtocolDriver
    monkeypatch.setattr(drivers, "__path__", [*drivers.__path__, str(tmp_path)])
    monkeypatch.syspath_prepend(tmp_path)
    text = (
        "from furuta_hw.drivers.serial_protocol.driver import SerialProtocolDriver\n"
        "from furuta_hw.connection.rig_driver import RigDriver\n"
        "class Driver(SerialProtocolDriver): pass\n"
        "class Incomplete(RigDriver):\n    def open(self): pass\n"
    )
    (tmp_path / "dropped_driver.py").write_text(text)
    assert find_driver("dropped_driver").__module__ == "furuta_hw.drivers.dropped_driver"
    with pytest.raises(ParameterError, match="'dropped_driver:Driver' is not accepted"):
        find_driver("dropped_driver:Driver")
    assert "dropped_driver" not in sys.modules
    accept_parts(["dropped_driver:Driver", "dropped_driver:Incomplete"])
    assert find_driver("dropped_driver:Driver").__module__ == "dropped_driver"
    with pytest.raises(RigError, match="does not implement arm, close, decode, drive, read"):
        find_driver("dropped_driver:Incomplete")
