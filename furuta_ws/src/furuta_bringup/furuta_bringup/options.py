"""Options that several verbs have.

Help shows them without numerical code: what computes is imported when a verb runs.
"""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial, wraps
from pathlib import Path
from typing import Any, TypeVar, cast

import click

from furuta_bringup.option_types import FIGURE, PATH, FiniteRange
from furuta_model.accepted_parts import accept_parts, parts_in
from furuta_model.friction.names import LAWS
from furuta_model.parameters import ParameterError, suggestion
from furuta_recordings.readers import Mapping as Names
from furuta_ros.middleware import ros_domain
from furuta_ros.one_graph import full_namespace
from furuta_ros.time_stamps import MOST_SECONDS

Function = TypeVar("Function", bound=Callable[..., Any])


class HelpfulGroup(click.Group):
    """A group that without arguments shows its help on standard error, with exit status 2.

    click itself does so since 8.2; before, it shows the help as a result.
    """

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Show the help if there is nothing to parse."""
        if not args and not ctx.resilient_parsing:
            click.echo(ctx.get_help(), err=True)
            ctx.exit(2)
        return super().parse_args(ctx, args)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command's name, the command and the other arguments; suggests like ones."""
        known = self.list_commands(ctx)
        if args[0] not in known and (near := suggestion(args[0], known)):
            ctx.fail(f"No such command {args[0]!r}{near}")
        return super().resolve_command(ctx, args)


class Option(click.Option):
    """An option that declares with which others it has an effect; it is refused otherwise.

    It ``needs`` one of some others, has no effect ``not_with`` some, and is not repeated
    ``once_with`` some. They are given as on the command line, with a value or without:
    "--running", "--command none".
    """

    def __init__(
        self,
        *args: Any,
        needs: Sequence[str] = (),
        not_with: Sequence[str] = (),
        once_with: Sequence[str] = (),
        **settings: Any,
    ) -> None:
        super().__init__(*args, **settings)
        self.needs, self.not_with, self.once_with = needs, not_with, once_with

    def handle_parse_result(
        self, ctx: click.Context, opts: Mapping[str, Any], args: list[str]
    ) -> tuple[Any, list[str]]:
        """The value, unless the other options leave it without effect."""
        if self.name in opts and not ctx.resilient_parsing:
            self._refuse_without_effect(ctx, opts)
        return super().handle_parse_result(ctx, opts, args)

    def _refuse_without_effect(self, ctx: click.Context, opts: Mapping[str, Any]) -> None:
        def first_of(others: Sequence[str]) -> str:
            return next((other for other in others if _is_given(ctx, opts, other)), "")

        own = self.opts[0]
        if self.needs and not first_of(self.needs):
            ctx.fail(f"{own} needs {' or '.join(self.needs)}")
        if other := first_of(self.not_with):
            ctx.fail(f"{own} cannot be combined with {other}")
        if self.multiple and len(opts[self.name or ""]) > 1 and (other := first_of(self.once_with)):
            ctx.fail(f"{own} can be given only once with {other}")


class Command(click.Command):
    """A command that needs one of several options or arguments, of each of some groups."""

    def __init__(self, *args: Any, one_of: Sequence[Sequence[str]] = (), **settings: Any) -> None:
        super().__init__(*args, **settings)
        self.one_of = one_of

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Refuse arguments that lack one of a group."""
        rest = super().parse_args(ctx, args)
        for group in () if ctx.resilient_parsing else self.one_of:
            given = {n: value for n, value in ctx.params.items() if value not in (None, ())}
            if not any(_is_given(ctx, given, each) for each in group):
                ctx.fail(f"give {', or '.join(group)}")
        return rest


def _is_given(ctx: click.Context, opts: Mapping[str, Any], text: str) -> bool:
    """Whether an option or argument has a value, or the value that the text has behind it."""
    name, _, value = text.partition(" ")
    for each in ctx.command.params:
        if name in (*each.opts, each.human_readable_name.strip("[]")):
            # What is not given is None, or of a type that only click has.
            given = opts.get(each.name or "")
            known = isinstance(given, str | int | float | tuple | list | Path)
            return known and given not in ((), []) and value in ("", given)
    raise AssertionError(f"no option {name}")


def option(*names: str, help: str, **settings: Any) -> Callable[[Function], Function]:
    """An :class:`Option` whose help shows its default, if it has one."""
    shown = settings.get("default") not in (None, "")
    return click.option(*names, cls=Option, help=help, show_default=shown, **settings)


# Pendulum time [s] of a simulation, and of one that is measured after its transients.
SIMULATED_SECONDS = FiniteRange(0, MOST_SECONDS, min_open=True)
MEASURED_SECONDS = FiniteRange(5, 3600)
SEED = click.IntRange(0, 2**62)


def figure_option(drawn: str, **rules: Sequence[str]) -> Callable[[Function], Function]:
    """``--figure FILE``, which draws the result."""
    return option("--figure", type=FIGURE, help=drawn, **rules)


def model_options(function: Function) -> Function:
    """``--rig NAME|FILE``, and ``--params FILE`` and ``--set NAME=VALUE``, both repeatable.

    The verb receives the rig's file as the first of its parameter files.
    """

    @wraps(function)
    def with_rig(*args: Any, rig: str, files: tuple[Path, ...], **others: Any) -> Any:
        if rig:
            from furuta_hw.rigs.known_rigs import rig_file

            files = (rig_file(rig), *files)
        return function(*args, files=files, **others)

    return rig_option(parameter_options(cast(Function, with_rig)))


rig_option = click.option(
    "--rig",
    default="",
    metavar="NAME|FILE",
    help="Rig whose model, friction, sensors and sample time every node uses.",
)


def _given(ctx: click.Context, param: Any, assignments: tuple[str, ...]) -> tuple[str, ...]:
    ctx.call_on_close(partial(_tell_all, assignments))
    return assignments


def _tell_all(assignments: tuple[str, ...]) -> None:
    """Say after the verb which parameters an assignment has set if its name means several."""
    if sys.exc_info()[0]:
        return  # an error is one line
    from furuta.settings.parameter_names import parameters_named

    for assignment in assignments:
        matches = parameters_named(assignment.partition("=")[0].strip())
        if len(matches) > 1:
            names = ", ".join(f"{match.node}.{match.parameter.name}" for match in matches)
            click.echo(f"{assignment} set {names}", err=True)


def _accept(ctx: click.Context, param: click.Parameter, names: tuple[str, ...]) -> None:
    for given in names:
        accept_parts(parts_in(given))


own_parts_option = click.option(
    "--own-parts",
    multiple=True,
    is_eager=True,
    expose_value=False,
    callback=_accept,
    metavar="NAME",
    help="Allow parameters to name this code of yours: module:function or file.py:function; "
    "repeatable.",
)


def parameter_options(function: Function) -> Function:
    """``--params FILE``, ``--set NAME=VALUE`` and ``--own-parts NAME``, all repeatable."""
    function = own_parts_option(function)
    function = click.option(
        "--set",
        "assignments",
        multiple=True,
        metavar="NAME=VALUE",
        callback=_given,
        help="Set a parameter: alpha0=0.3 in every node that has it, plant.friction.alpha0=0.3 in "
        "one; repeatable.",
    )(function)
    return click.option(
        "--params",
        "files",
        multiple=True,
        type=PATH,
        metavar="FILE",
        help="ROS parameter file, or rig file; repeatable.",
    )(function)


def _law(ctx: click.Context, param: click.Parameter, value: str | None) -> str | None:
    if value and ":" not in value and value not in LAWS:
        raise click.BadParameter(
            f"{value!r} is not one of {', '.join(map(repr, LAWS))}{suggestion(value, LAWS)}"
        )
    return value


law_option = click.option(
    "--law",
    callback=_law,
    metavar="NAME",
    help=f"Friction law: {', '.join(LAWS)}, or one of --own-parts; default: plant.friction.law.",
)

feedback_option = click.option(
    "--feedback",
    nargs=4,
    type=float,
    metavar="L1 L2 L3 L4",
    help="Feedback u = l·x; default: the controller's gain.",
)


def _namespace(ctx: click.Context, param: click.Parameter, value: str) -> str:
    try:
        return full_namespace(value)
    except ParameterError as error:
        raise click.BadParameter(str(error)) from None


def namespaced(**rules: Sequence[str]) -> Callable[[Function], Function]:
    """``--namespace NAME``."""
    return option(
        "--namespace",
        default="",
        metavar="NAME",
        callback=_namespace,
        help="ROS namespace of the graph.",
        **rules,
    )


namespace_option = namespaced()


@contextmanager
def joined_node(name: str, namespace: str) -> Iterator[tuple[Any, Any]]:
    """A node that joins the graph of a namespace as its client, and its executor."""
    from rclpy.node import Node

    from furuta_ros.spinning import executor_of, ros_context

    with ros_context(namespace=namespace):
        node = Node(name, start_parameter_services=False)
        yield node, executor_of([node])
        tell_graph(namespace)


def tell_graph(namespace: str, what: str = "graph:") -> None:
    """Say on standard error which graph this process has joined."""
    print(f"{what} namespace {namespace or '/'}, ROS domain {ros_domain()}", file=sys.stderr)


def names_options(function: Function) -> Function:
    """Names in another rig's recording; the verb receives them as ``names``."""

    @wraps(function)
    def with_names(*args: Any, **others: Any) -> Any:
        given = {name: others.pop(f"{name}_name") for name in Names._fields}
        return function(*args, names=Names(**given), **others)

    for name, text in (
        ("rate", "Rows per second [Hz] of a table without times."),
        ("columns", "Names of the columns of a table without a header, separated by commas."),
        ("time", "Column of the time in a table."),
        ("states", "Topic of the joint states."),
        ("command", "Topic or column of the command; effort: that of the joint states."),
        ("pendulum", "Name of the pendulum's joint, in a recording of another rig."),
        ("arm", "Name of the arm's joint, in a recording of another rig."),
    ):
        kind = FiniteRange(0.0, 1e12, min_open=True) if name == "rate" else None
        with_names = click.option(f"--{name}", f"{name}_name", type=kind, help=text)(with_names)
    return cast(Function, with_names)


json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object and nothing else."
)
