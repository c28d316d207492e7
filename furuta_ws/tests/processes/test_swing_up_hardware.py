"""Swing-up on an emulated rig behind a pseudo-terminal: it is caught."""

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from bridge_bench import hold_and_arm
from rclpy.parameter import Parameter
from testbench import Bench

from furuta.studies.swing_up import swing_up_settings
from furuta_control.controller_node import ControllerNode
from furuta_control.estimator_node import EstimatorNode
from furuta_friction.friction_observer_node import FrictionObserverNode
from furuta_hw.bridge.bridge_node import HardwareBridgeNode
from furuta_hw.rigs.known_rigs import find_rig, rig_directory
from furuta_model.state import THETA
from furuta_ros.topics import ACTIVE_MODE, LATCHED

pytestmark = pytest.mark.timeout(900)

NAME = "qube_servo_2"
# Wide enough for a loaded machine [s].
WATCHDOG, AGE = 0.2, 5.0
PATIENCE = 240.0
SETTINGS = swing_up_settings(find_rig(NAME))
LONGEST = 8000  # samples in which it must be caught


def write_rig(directory: Path, age: float) -> Path:
    """The rig's file with a long watchdog, and limits on ages that a loaded machine keeps."""
    content = yaml.safe_load((rig_directory() / f"{NAME}.yaml").read_text())
    content["line"]["watchdog"] = WATCHDOG
    content["limits"] |= dict.fromkeys(("command_age", "measurement_age", "estimate_age"), age)
    path = directory / "rig.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def overrides(node: str) -> list[Parameter]:
    """A node's parameters for swing-up on the rig."""
    return [Parameter(name, value=value) for name, value in SETTINGS[node].items()]


def test_swings_up_over_the_serial_line(bench: Bench, emulate: Any, tmp_path: Path) -> None:
    """From hanging the real graph brings the pendulum upright, and balances it."""
    rig_file = write_rig(tmp_path, AGE)
    rig = emulate("--lockstep", "--rig", rig_file, "--initial", f"theta={-pi}")
    bridge = bench.add(
        HardwareBridgeNode(
            [
                Parameter("port", value=str(rig.port)),
                Parameter("rig", value=str(rig_file)),
                Parameter("autostart", value="active"),
                Parameter("any_pendulum_angle", value=True),
            ]
        )
    )
    bench.add(EstimatorNode(overrides("estimator")))
    bench.add(FrictionObserverNode(overrides("friction_observer")))
    bench.add(ControllerNode(overrides("controller")))
    modes: list[str] = []
    bench.probe.create_subscription(
        ACTIVE_MODE.type, ACTIVE_MODE.name, lambda message: modes.append(message.data), LATCHED
    )
    assert bridge.start_up() == ""
    bench.spin(lambda: not hold_and_arm(bench, rig), PATIENCE)
    begun = rig.status["driven"]
    bench.spin(lambda: modes[-1] == "balance" or rig.status["driven"] > begun + LONGEST, PATIENCE)
    assert modes[-1] == "balance", (modes, bridge.guard.reason)
    assert bridge.guard.stops == 0
    assert np.cos(rig.status["state"][THETA]) > 0.95
