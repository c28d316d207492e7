"""Entry points of the executables; they import a node once Ctrl-C can end the process."""

from furuta_ros.process import run_entry


def estimator() -> None:
    """Entry point of the executable ``estimator``."""
    run_entry("furuta_control.estimator_node:main")


def controller() -> None:
    """Entry point of the executable ``controller``."""
    run_entry("furuta_control.controller_node:main")
