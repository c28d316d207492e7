"""Parameter files, generated from the declarations of the parameters."""

from collections.abc import Iterator
from typing import NamedTuple

import yaml

from furuta.settings.nodes import NODES
from furuta.settings.settings import Settings
from furuta_model.parameters import Declared, build, declared, values


def settings_file(settings: Settings) -> str:
    """A ROS parameter file with every value of these settings, defaults included."""
    return yaml.safe_dump(
        {
            name: {"ros__parameters": values(build(node.parameters, settings[name]))}
            for name, node in NODES.items()
        },
        sort_keys=False,
    )


def parameter_file(node: str) -> str:
    """A ROS parameter file with the defaults of ``node``."""
    return "\n".join(
        [
            f"# Parameters of the node {node} with their defaults.",
            f"{node}:",
            "  ros__parameters:",
            *_lines(NODES[node].parameters),
            "",
        ]
    )


def _lines(group: type[NamedTuple]) -> Iterator[str]:
    open_section = ""
    # Names without a section first: a mapping cannot be continued after another one.
    for parameter in sorted(declared(group), key=_section):
        section, name = _section(parameter), parameter.name.rpartition(".")[2]
        if section != open_section:
            yield f"    {section}:"
            open_section = section
        indent = "      " if section else "    "
        yield f"{indent}# {describe(parameter)}"
        yield f"{indent}{name}: {_yaml(parameter.default)}"


def _section(parameter: Declared) -> str:
    return parameter.name.rpartition(".")[0]


def describe(parameter: Declared) -> str:
    """Meaning, unit and range in one line."""
    about = parameter.about
    allowed = "" if about.allowed == "any" or about.choices else f", {about.allowed}"
    fixed = "; at start only" if about.read_only else ""
    unit = f" [{about.unit}]" if about.unit else ""
    return f"{about.meaning}{unit}{allowed}{fixed}"


def _yaml(value: object) -> str:
    given = list(value) if isinstance(value, tuple) else value
    return yaml.safe_dump(given, default_flow_style=True, width=1000).partition("\n")[0]
