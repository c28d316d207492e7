"""The command line ``furuta``: a verb is a module of ``verbs`` and a line in ``VERBS``."""

from __future__ import annotations

import importlib
import logging
import sys

import click

from furuta_cli.printing import printable
from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError

VERBS = {
    "demo": "Compare four compensations on the real node graph.",
    "run": "Run the graph until Ctrl-C.",
    "simulate": "Simulate the same closed loop without ROS.",
    "experiment": "Reproduce Figs 5 to 9 of the paper without ROS.",
    "tune": "Tune the compensator for the smallest limit cycle.",
    "sweep": "Simulate many parameter values, on all cores or on a cluster.",
    "sensitivity": "Remaining limit cycle over the sensor noise.",
    "linearize": "Linear model, poles, and the gain by pole placement.",
    "limit-cycle": "Exact limit cycle, and its branches over a parameter.",
    "map": "Map of the limit cycle over two parameters.",
    "nyquist": "Nyquist plot from friction to arm speed, and its crossings (Fig. 4).",
    "describing-function": "Limit cycles predicted by the describing function of friction.",
    "convergence": "Passivity condition for convergence of the friction observer.",
    "identify": "Identify a model from recordings.",
    "bag": "Show, recover, replay and recompute recorded bags.",
    "hw": "Commission a real rig, arm it, or emulate one.",
    "param": "Read and set parameters of running nodes; print parameter files.",
    "node": "List the running nodes, or run one.",
}


class Verbs(click.Group):
    """The group of all verbs; imports a verb's module only when that verb is used."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All verbs."""
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The verb's command."""
        if cmd_name not in VERBS:
            return None
        module = importlib.import_module(f"furuta_cli.verbs.{cmd_name.replace('-', '_')}")
        command: click.Command = module.command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List all verbs without importing them."""
        with formatter.section("Verbs"):
            formatter.write_dl(list(VERBS.items()))


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
def furuta() -> None:
    """Friction and friction compensation in the Furuta pendulum, on ROS 2."""


def main() -> None:
    """Entry point of the executable ``furuta``."""
    run_command(furuta, "furuta")


def run_command(command: click.Command, name: str) -> None:
    """Run a command with the arguments of the process, and end the process.

    Its exit status is 0 (done), 1 (failed, with one line on standard error) or 2 (wrong usage).
    """
    logging.basicConfig(format="%(levelname)s: %(message)s")
    try:
        command(prog_name=name)
    except (ParameterError, UserError) as error:
        _fail(str(error))
    except OSError as error:
        _fail((f"{error.filename}: " if error.filename else "") + str(error.strerror))
    except MemoryError:
        _fail("not enough memory")


def _fail(reason: str) -> None:
    """End the process with one line on standard error."""
    print(f"error: {printable(reason)}", file=sys.stderr)
    sys.exit(1)
