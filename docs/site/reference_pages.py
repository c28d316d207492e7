"""Writes the pages of the reference from the code: ``python docs/site/reference_pages.py FOLDER``.

Verbs, parameters, rig files and the names of the library go into the folder, from which the site
takes them. The tables of docs/topics.md are written in its place; a test compares them.
"""

import inspect
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import click

import furuta
from furuta.figures.labels import SYMBOLS
from furuta_bringup.main import furuta as command_line
from furuta_graph.settings.nodes import NODES
from furuta_hw.rigs.physical import PhysicalParameters
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import LinearCoefficients
from furuta_hw.rigs.uncertainty import ABSOLUTE, RELATIVE
from furuta_model.parameters import About, Declared, ParameterError, declared
from furuta_recordings.series_columns import column_table
from furuta_ros.topics import EVERY_TOPIC, THROTTLED_TOPICS, Topic

DOCS = Path(__file__).resolve().parents[1]
GENERATED = "Generated from the code by `docs/site/reference_pages.py`."
# Width of the text of ``--help`` in characters.
WIDTH = 100


def verbs_page() -> str:
    """Every verb with its options, as ``--help`` prints them."""
    parts = [
        f"# Verbs\n\n{GENERATED} `./furuta VERB --help` prints the same.\n\n"
        "Every verb ends with status 0 (done), 1 (failed, with the reason in one line on standard "
        "error), 2 (wrong\nusage) or 130 (Ctrl-C). `--json` prints one JSON object and nothing "
        "else.\n"
    ]
    context = click.Context(command_line, info_name="./furuta", **command_line.context_settings)
    for name in command_line.list_commands(context):
        command = command_line.get_command(context, name)
        if command is not None:
            parts += _help_texts(name, command, context, "##")
    return "\n".join(parts)


def _help_texts(
    name: str, command: click.Command, parent: click.Context, heading: str
) -> Iterator[str]:
    context = click.Context(
        command, parent=parent, info_name=name, terminal_width=WIDTH, max_content_width=WIDTH
    )
    title = context.command_path.removeprefix("./furuta ")
    yield f"{heading} {title}\n\n```text\n{command.get_help(context)}\n```\n"
    if isinstance(command, click.Group):
        for subcommand in command.list_commands(context):
            inner = command.get_command(context, subcommand)
            if inner is not None:
                yield from _help_texts(subcommand, inner, context, heading + "#")


def parameters_page() -> str:
    """Every parameter of every node."""
    return (
        f"# Parameters\n\n{GENERATED} `./furuta param defaults NODE` prints them as a parameter "
        "file, and\n[furuta_ws/config](../furuta_ws/config) holds those files.\n\n"
        + "\n".join(
            line
            for node in NODES.values()
            for line in (f"## {node.name}\n", *_parameter_table(node.parameters))
        )
    )


def topic_rows(topics: Iterable[Topic]) -> list[str]:
    """The topics as a table in Markdown."""
    return [
        "| topic | type | from → to | content |",
        "|---|---|---|---|",
        *(
            f"| `{topic.name}` | {_message_type(topic.type)} | {topic.ends} | {topic.content} |"
            for topic in topics
        ),
    ]


def _message_type(message: type) -> str:
    package, *_ = message.__module__.split(".")
    return f"{package}/{message.__name__}"


def topics_page() -> str:
    """The topics and the columns of series, and what docs/topics.md says about bags."""
    page = (DOCS / "topics.md").read_text()
    return "\n".join(
        [
            "# Topics and bags\n",
            "Names are relative: in the namespace `left`, `command` becomes `/left/command`. The "
            "joints are `arm` (φ) and\n`pendulum` (θ, zero upright). Torque and friction are in "
            "volts at the drive. All topics are reliable with depth 10.\n",
            *topic_rows(EVERY_TOPIC),
            f"\n{_code(topic.name for topic in THROTTLED_TOPICS)} each have a copy for programs "
            "that draw,\nsuch as `command_throttle`, with about 100 messages per second of the "
            "loop's time.\n",
            "## Columns of exported series\n",
            *column_table(),
            page[page.index("\n## Record") :],
        ]
    )


def rig_files_page() -> str:
    """The keys of rig files."""
    sections: dict[str, list[Declared]] = {}
    for field in declared(Rig):
        sections.setdefault(field.name.partition(".")[0], []).append(field)
    parts = [
        f"# Rig files\n\n{GENERATED} [A real rig](hardware.md#rig-files) explains them.\n",
        "![φ, θ, u, F, L and l of a pendulum](pendulum.png)\n",
        "The drawing shows the positive directions. A positive voltage drives the arm towards "
        "positive φ, and θ grows in\nthe direction in which the end of the arm then moves. L is "
        "`physical.arm_length`, l is `physical.pendulum_length`.\n",
        "A rig file is a YAML file with the sections below. What it does not give has the "
        "default, the paper's rig. Give\nthe pendulum in one of three forms: `model`, `linear` or "
        "`physical`. `name`, `sources` and `notes` hold text.\n",
    ]
    for name, rows in sections.items():
        parts += _rig_section(name, rows)
        if name == "model":
            for form, group in (("linear", LinearCoefficients), ("physical", PhysicalParameters)):
                parts += _rig_section(form, list(declared(group, f"{form}.")))
    parts += [
        "## uncertainty\n",
        "`standard_errors` maps names to numbers, `correlations` is a lower triangle.\n",
        f"Relative: {_code(RELATIVE)}. `arm_inertia` is α − γ²/β.\n",
        f"In the unit of the value: {_code(ABSOLUTE)}.\n",
    ]
    return "\n".join(parts)


def _code(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _rig_section(name: str, rows: list[Declared]) -> Iterator[str]:
    yield f"## {name}\n"
    yield "| key | symbol | default | unit | allowed | meaning |\n|---|---|---|---|---|---|"
    for row in rows:
        key = row.name.partition(".")[2]
        symbol, meaning = _symbol(name, key, row.about)
        default = f"{row.default:.6g}" if isinstance(row.default, float) else row.default
        yield (
            f"| `{key}` | {symbol} | {_plain(default)} | {row.about.unit} | {row.about.allowed} "
            f"| {meaning} |"
        )
    yield ""


def _symbol(section: str, key: str, about: About) -> tuple[str, str]:
    """Symbol and meaning; the physical parameters have theirs in front of the meaning."""
    if section == "physical":
        symbol, _, meaning = about.meaning.partition(", ")
        return symbol, meaning or about.meaning
    return SYMBOLS.get(key, ""), about.meaning


def _plain(value: Any) -> str:
    return str(list(value) if isinstance(value, tuple) else value) or '""'


def library_page() -> str:
    """Every public name of the library with its signature and docstring."""
    parts = [
        "# Library, name by name\n",
        f"{GENERATED} `help(furuta.NAME)` prints the same; [library](library.md) is the "
        "overview.\n",
    ]
    for name in sorted(furuta.__all__, key=str.lower):
        thing = getattr(furuta, name)
        if inspect.isfunction(thing):
            parts += [f"## {name}\n", f"```python\n{_signature(name, thing)}\n```\n", _text(thing)]
        elif inspect.isclass(thing):
            parts += [f"## {name}\n", _text(thing), *_field_table(thing)]
    return "\n".join(parts).rstrip() + "\n"


def _signature(name: str, function: Any) -> str:
    parameters = inspect.signature(function).parameters.values()
    lines = [f"    {_parameter(parameter)}," for parameter in parameters]
    if any(parameter.kind is parameter.KEYWORD_ONLY for parameter in parameters):
        first = next(
            i for i, parameter in enumerate(parameters) if parameter.kind is parameter.KEYWORD_ONLY
        )
        lines.insert(first, "    *,")
    result = _type(inspect.signature(function).return_annotation)
    return "\n".join([f"{name}(", *lines, f") -> {result}"]) if lines else f"{name}() -> {result}"


def _parameter(parameter: inspect.Parameter) -> str:
    """A parameter as it is written; a long default is only said to exist."""
    text = f"{parameter.name}: {_type(parameter.annotation)}"
    if parameter.default is parameter.empty:
        return text
    default = repr(parameter.default)
    return f"{text} = {default if len(default) < 40 else '...'}"


def _type(annotation: Any) -> str:
    """An annotation without the modules of its names."""
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    return re.sub(r"(\w+\.)+(?=\w)", "", text)


def _text(thing: Any) -> str:
    """A Google-style docstring as Markdown."""
    text = re.sub(r":\w+:`~?(?:[\w.]*\.)?(\w+)`", r"`\1`", inspect.cleandoc(thing.__doc__ or ""))
    text = re.sub(r":math:`([^`]*)`", r"\1", text).replace("``", "`")
    text = re.sub(r"^\.\. math::\n", "", text, flags=re.MULTILINE)
    lines: list[str] = []
    in_list = False
    for line in text.splitlines():
        if re.fullmatch(r"(Args|Returns|Raises|Attributes|Yields):", line):
            lines += [f"**{line[:-1]}**", ""]
            in_list = line not in ("Returns:", "Yields:")
        elif line.startswith("    ") and in_list:
            item = re.match(r"    (\*{0,2}\w+): (.*)", line)
            lines.append(f"- `{item[1]}`: {item[2]}" if item else f"  {line.strip()}")
        elif line.startswith("    ") and lines and "**Returns**" in lines[-2:]:
            lines.append(line.strip())
        else:
            in_list = in_list and not line
            lines.append(line)
    return "\n".join(lines) + "\n"


def _field_table(thing: Any) -> list[str]:
    """The declared fields of a group of parameters; nothing for other classes."""
    try:
        rows = declared(thing) if hasattr(thing, "_fields") else ()
    except (IndexError, KeyError, ParameterError):
        rows = ()
    return _parameter_table(thing) if 0 < len(rows) <= 40 else []


def _parameter_table(group: type[NamedTuple]) -> list[str]:
    """A group of parameters as a table."""
    return [
        "| name | default | unit | allowed | meaning |\n|---|---|---|---|---|",
        *(
            f"| `{row.name}` | {_plain(row.default)} | {row.about.unit} | {row.about.allowed} "
            f"| {row.about.meaning}{'; at start only' if row.about.read_only else ''} |"
            for row in declared(group)
        ),
        "",
    ]


PAGES = {
    "verbs.md": verbs_page,
    "parameters.md": parameters_page,
    "rig-files.md": rig_files_page,
    "library-reference.md": library_page,
}


if __name__ == "__main__":
    (DOCS / "topics.md").write_text(topics_page())
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for file, page in PAGES.items():
        (folder / file).write_text(page())
