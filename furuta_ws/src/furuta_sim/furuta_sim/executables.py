"""Entry points of the executables; they import a node once Ctrl-C can end the process."""

from furuta_ros.process import run_entry


def plant() -> None:
    """Entry point of the executable ``plant``."""
    run_entry("furuta_sim.plant_node:main")
