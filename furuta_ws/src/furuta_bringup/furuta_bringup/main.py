"""The command line ``furuta``: a verb is a module of ``verbs`` and a line in ``VERBS``."""

import importlib
import logging
import sys
from importlib.metadata import packages_distributions, version
from importlib.util import find_spec
from typing import Any

import click

from furuta_bringup.options import HelpfulGroup
from furuta_bringup.printing import print_in_any_encoding, printable
from furuta_model.optional import missing
from furuta_model.parameters import ParameterError, suggestion
from furuta_ros.errors import UserError
from furuta_ros.process import INTERRUPTED, end_with_parent, exit_on_interrupt

VERBS = {
    "demo": "Compare compensations on the real node graph.",
    "run": "Run the graph until Ctrl-C.",
    "view": "Show the graph in a browser, with all parameters.",
    "page": "Open the simulation in a browser, without ROS.",
    "simulate": "Simulate the same closed loop without ROS.",
    "swing-up": "Swing up from random states, with knocks.",
    "tune": "Tune the compensator for the smallest limit cycle.",
    "sweep": "Simulate many parameter values, on all cores or on a cluster.",
    "compare": "Compare compensations on rigs that they do not know.",
    "linearize": "Linear model, poles, gain, margins; Nyquist plot; passivity.",
    "limit-cycle": "Limit cycle, exact or predicted; its branches and maps.",
    "export": "Export the tuned loop as C for a microcontroller.",
    "axis": "Hunting of a servo axis with friction, and what helps.",
    "identify": "Identify a model from recordings.",
    "bag": "Show, export, recover and replay recorded bags.",
    "hw": "Commission a real rig, arm it, or emulate one.",
    "param": "Parameters of running nodes; parameter files.",
}


def _load(verb: str) -> click.Command:
    try:
        module = importlib.import_module(f"furuta_bringup.verbs.{verb.replace('-', '_')}")
    except ModuleNotFoundError as error:
        raise _explained(error, verb) from None
    command: click.Command = module.command
    return command


def _explained(error: ModuleNotFoundError, verb: str | None) -> Exception:
    """What to raise if ``verb`` imports what is not installed."""
    if (error.name or "").startswith("furuta"):
        return error
    name = (error.name or "").partition(".")[0]
    if name in sys.stdlib_module_names:
        return UserError(f"furuta {verb} needs Linux, whose Python has the module {name}")
    of_ros = (
        name == "rclpy" or name.startswith(("rcl_", "ament_")) or name.endswith(("_msgs", "_srvs"))
    )
    if not of_ros and error.name != name and find_spec(name):
        return UserError(f"furuta {verb} needs a newer {name}: pip install --upgrade {name}")
    ros = "ROS 2 Jazzy, or on Linux x86-64 pip install '.[ros]' in a clone of the repository"
    without = "; furuta page opens the simulation without it" if verb == "view" else ""
    return UserError(missing(name, f"furuta {verb}", ros if of_ros else "") + without)


class Verbs(HelpfulGroup):
    """The group of all verbs; imports a verb's module only when that verb is used."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All verbs."""
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The verb's command."""
        if cmd_name not in VERBS:
            return None
        return _load(cmd_name)

    def invoke(self, ctx: click.Context) -> Any:
        """Run a verb, which may import some packages only then."""
        try:
            return super().invoke(ctx)
        except ModuleNotFoundError as error:
            raise _explained(error, ctx.invoked_subcommand) from None
        except click.UsageError as error:
            verb = ctx.invoked_subcommand
            if error.ctx is None and verb in VERBS:  # so that the error names the verb's help
                error.ctx = click.Context(_load(verb), ctx, verb)
            raise

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List all verbs without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(VERBS.items()))


def _print_version(ctx: click.Context, param: click.Parameter, value: bool) -> None:
    """Print the version of the workspace's package, or of the wheel that contains it."""
    if value and not ctx.resilient_parsing:
        print("furuta", version(packages_distributions()["furuta_bringup"][0]))
        ctx.exit()


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_version,
    help="Print the version.",
)
def furuta() -> None:
    """Friction and friction compensation in the Furuta pendulum, on ROS 2."""


def main() -> None:
    """Entry point of the executable ``furuta``."""
    exit_on_interrupt()
    end_with_parent()
    run_verb()


def run_verb() -> None:
    """Run the verb that the arguments of the process name, and end the process.

    Its exit status is 0 (done), 1 (failed), 2 (wrong usage) or 130 (Ctrl-C). Each error is one line
    on standard error.
    """
    print_in_any_encoding()
    logging.basicConfig(format="%(levelname)s: %(message)s")
    try:
        status = furuta.main(prog_name="furuta", standalone_mode=False)
    except (KeyboardInterrupt, click.Abort):
        status = INTERRUPTED
    except click.ClickException as error:
        status = _fail(_sentence(error), error.exit_code)
    except (ParameterError, UserError) as error:
        status = _fail(str(error))
    except OSError as error:
        file = f"{error.filename}: " if error.filename else ""
        status = _fail(f"{file}{error.strerror}")
    except MemoryError:
        status = _fail("not enough memory")
    except AttributeError as error:
        module = getattr(error.obj, "__name__", "")
        if module not in sys.stdlib_module_names:
            raise
        status = _fail(f"this needs Linux, whose Python has {module}.{error.name}")
    sys.exit(status or 0)


def _fail(reason: str, status: int = 1) -> int:
    """Print one line on standard error; return the exit status."""
    print(f"error: {printable(reason)}", file=sys.stderr)
    return status


def _sentence(error: click.ClickException) -> str:
    """What is wrong in one line, and where the usage is explained."""
    text = " ".join(error.format_message().split()).rstrip(".")
    if isinstance(error, click.BadOptionUsage) and text.endswith("arguments"):
        text += ", separated by blanks"
    context = getattr(error, "ctx", None)
    if isinstance(error, click.NoSuchOption) and context:  # click's own suggests much
        names = (name for each in context.command.get_params(context) for name in each.opts)
        text = f"No such option {error.option_name!r}{suggestion(error.option_name, names)}"
    return f"{text} (see {context.command_path} --help)" if context else text
