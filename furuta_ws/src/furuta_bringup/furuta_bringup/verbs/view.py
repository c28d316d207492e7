"""``furuta view``."""

import os
import subprocess
import sys

import click

from furuta.settings.nodes import PLANT
from furuta_bringup.graph.scheduling import may_have_priority
from furuta_bringup.options import namespace_option, option, own_parts_option
from furuta_bringup.printing import with_status
from furuta_model.accepted_parts import accepted_parts
from furuta_model.parameters import ParameterError

# How far the page stands back for the loop when both want a core.
NICENESS = 10
# Priority in real time of the graph, if the system permits it: a browser may take all cores. These
# options of the graph have their own, or would leave nothing for the page.
PRIORITY = 80
NOT_IN_TIME = ("--lockstep", "--processes", "--priority")


class _WithRunOptions(click.Command):
    """Says where options of ``furuta run`` belong."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """The arguments that are left."""
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            from furuta_bringup.verbs import run

            named = [each for each in run.command.params if error.option_name in each.opts]
            if not named:
                raise
            is_flag = getattr(named[0], "is_flag", False)
            value = "" if is_flag else f" {named[0].metavar or 'VALUE'}"
            example = f"furuta view -- {error.option_name}{value}"
            ctx.fail(f"options of furuta run follow after --: {example}")


@click.command(cls=_WithRunOptions)
@option("--attach", is_flag=True, help="Show a graph that runs already; start none.")
@option("--no-open", is_flag=True, help="Open no browser.")
@option("--port", type=click.IntRange(1, 65535), help="Port of the page; default: from 8080.")
@namespace_option
@own_parts_option
@click.argument("options", nargs=-1, type=click.UNPROCESSED, metavar="[-- RUN_OPTIONS]")
def command(
    attach: bool,
    no_open: bool,
    port: int | None,
    namespace: str,
    options: tuple[str, ...],
) -> None:
    """Run the graph and show it in a browser: pendulum, charts, and all parameters.

    The address of the page is the first line on standard output. Options of furuta run follow
    after --, for example: furuta view -- --lockstep
    """
    if attach and options:
        raise click.UsageError("--attach starts no graph: omit the options of furuta run")
    from furuta_bringup.graph.processes import executable  # first: it needs ROS, as all here does

    if attach:
        os.nice(NICENESS)  # before any thread starts: each has its own
        from furuta_bringup.page.live_page import run_page
        from furuta_bringup.page.server import PageServer

        run_page(PageServer(port), namespace, opens=not no_open)
        return
    from furuta_bringup.verbs import run
    from furuta_ros.middleware import ros_domain
    from furuta_ros.one_graph import claim
    from furuta_ros.process import child_environment

    # What would end the graph at once ends this command, before it prints an address.
    shared = ["--namespace", namespace] if namespace else []
    chosen = run.command.make_context("furuta run", [*shared, *options]).params
    claim(ros_domain(), namespace or "/").close()
    furuta = str(executable("furuta_bringup", "furuta"))
    page = ["--attach", *(["--no-open"] if no_open else [])]
    page += ["--port", str(port)] if port is not None else []
    page += (own := [word for name in accepted_parts() for word in ("--own-parts", name)])
    shown = subprocess.Popen(
        [furuta, "view", *page, *shared], env=child_environment(), stdout=subprocess.PIPE, text=True
    )
    assert shown.stdout is not None
    try:
        with with_status("starting"):
            settings = run.planned_graph(**chosen).settings  # while the page starts
            address = shown.stdout.readline()
    except ParameterError:
        shown.terminate()
        raise
    if not address:  # the page has failed, and has said why
        sys.exit(shown.wait())
    print(address, end="", flush=True)
    # Lock-step waits for the page, which lets it run in real time at first.
    plant = settings.get(PLANT, {})
    waits = plant.get("clock") == "lockstep" and "run_until" not in plant
    options += ("--set", f"{PLANT}.run_until=0") if waits else ()
    in_time = not any(option.startswith(NOT_IN_TIME) for option in options)
    prior = ["--priority", str(PRIORITY)] if in_time and may_have_priority(PRIORITY) else []
    # The graph takes the place of this process. The page ends with it; without the page it runs
    # on, since it may hold a pendulum upright.
    os.execv(furuta, [furuta, "run", *shared, *prior, *own, *options])
