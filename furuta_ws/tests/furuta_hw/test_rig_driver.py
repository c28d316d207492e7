"""The worked example of a rig driver, from the documentation, on the bridge node."""

import re
import sys
from pathlib import Path
from typing import Any

import pytest
from bridge_bench import PERMISSIVE_RIG, Loop, arm, bridge, spin_samples

from furuta_hw import drivers
from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_hw.commissioning.session import RigSession
from furuta_hw.connection import rig_connection
from furuta_hw.drivers.serial_protocol.driver import SerialProtocolDriver
from furuta_hw.errors import RigError
from furuta_hw.rigs.rig import Rig
from furuta_ros.testing import Bench
from furuta_ros.topics import MEASUREMENT

PAGE = Path(__file__).resolve().parents[3] / "docs" / "extending.md"


@pytest.fixture
def rig_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Drop the example's module into furuta_hw/drivers; returns a rig file that names it."""
    section = PAGE.read_text().partition("\n## A rig driver\n")[2].partition("\n## ")[0]
    blocks = re.findall(r"^```python title=(\S+)\n(.*?)^```$", section, re.M | re.S)
    ((title, text),) = blocks
    assert Path(title).parent.parts[-2:] == ("furuta_hw", "drivers")
    (tmp_path / Path(title).name).write_text(text)
    monkeypatch.setattr(drivers, "__path__", [*drivers.__path__, str(tmp_path)])
    monkeypatch.setattr(rig_connection, "RETRY_PERIOD", 60.0)
    file, name = tmp_path / "rig.yaml", Path(title).stem
    file.write_text(PERMISSIVE_RIG.replace("watchdog: 1.0", f"watchdog: 1.0, driver: {name}"))
    yield file
    sys.modules.pop(f"furuta_hw.drivers.{name}", None)


def test_an_exception_in_a_driver_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also while commissioning, where nothing else could catch it."""
    monkeypatch.setattr(SerialProtocolDriver, "decode", lambda self, data: data + None)
    with pytest.raises(RigError, match=r"<lambda> failed .* TypeError"), RigSession("mock", Rig()):
        pass


def armed(node: HardwareBridgeNode) -> bool:
    """Whether the simulated board is armed."""
    assert node.connection is not None
    driver: Any = node.connection._driver
    return bool(driver._board.armed)


def test_it_publishes_arms_drives_and_stops(bench: Bench, rig_file: Path) -> None:
    """The arm moves at 1 rad/s per volt of the command while armed, and not otherwise."""
    node = bridge(bench, rig=str(rig_file), autostart="active")
    received = bench.collect(MEASUREMENT)
    Loop(bench, 0.5)
    spin_samples(bench, node, 100)
    assert received[-1].position[0] == 0.0
    assert not armed(node)
    assert arm(bench) == (True, "")
    bench.spin(lambda: received[-1].velocity[0] == 0.5 and received[-1].position[0] > 0.05)
    assert received[-1].effort[0] == 0.5
    assert armed(node)
    assert arm(bench, armed=False) == (True, "disarmed")
    bench.spin(lambda: received[-1].effort[0] == 0.0)
    assert not armed(node)
    assert node.guard.reason == "disarmed by request"
