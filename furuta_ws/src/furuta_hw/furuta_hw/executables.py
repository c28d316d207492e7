"""Entry points of the executables; they import a node once Ctrl-C can end the process."""

from furuta_ros.process import run_entry


def hardware_bridge() -> None:
    """Entry point of the executable ``hardware_bridge``."""
    run_entry("furuta_hw.bridge.bridge_node:main")


def rig_emulator() -> None:
    """Entry point of the executable ``rig_emulator``."""
    run_entry("furuta_hw.emulator.rig_emulator:main")
