"""Entry points of the executables; they import a node once Ctrl-C can end the process."""

from furuta_ros.process import run_entry


def friction_observer() -> None:
    """Entry point of the executable ``friction_observer``."""
    run_entry("furuta_friction.friction_observer_node:main")
