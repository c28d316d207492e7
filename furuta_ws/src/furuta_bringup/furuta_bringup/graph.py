"""The executable ``graph``: the whole graph in one process."""

from furuta_bringup.main import run_verb


def main() -> None:
    """Entry point of the executable ``graph``, which has the arguments of ``furuta run``."""
    run_verb("run", "graph")
