"""Parameter files and tables, generated from the declarations of the parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import yaml

from furuta_model.parameters import Declared, build, declared, values
from furuta_sim.settings.nodes import NODES
from furuta_sim.settings.settings import Settings


def settings_file(settings: Settings) -> str:
    """A ROS parameter file with every value of these settings, defaults included."""
    return yaml.safe_dump(
        {
            node: {"ros__parameters": values(build(each.parameters, settings[node]))}
            for node, each in NODES.items()
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
    open_group = ""
    # Names without a group first: a mapping cannot be continued after another one.
    for each in sorted(declared(group), key=lambda each: each.name.rpartition(".")[0]):
        section, _, name = each.name.rpartition(".")
        if section != open_group:
            yield f"    {section}:"
            open_group = section
        indent = "      " if section else "    "
        yield f"{indent}# {describe(each)}"
        yield f"{indent}{name}: {_yaml(each.default)}"


def describe(each: Declared) -> str:
    """Meaning, unit and range in one line."""
    about = each.about
    allowed = "" if about.allowed == "any" or about.choices else f", {about.allowed}"
    fixed = "; at start only" if about.read_only else ""
    unit = f" [{about.unit}]" if about.unit else ""
    return f"{about.meaning}{unit}{allowed}{fixed}"


def parameter_table(node: str) -> str:
    """The parameters of ``node`` as a table in Markdown."""
    rows = [
        f"| `{each.name}` | {_yaml(each.default)} | {each.about.unit} | {each.about.allowed} "
        f"| {each.about.meaning}{'; at start only' if each.about.read_only else ''} |"
        for each in declared(NODES[node].parameters)
    ]
    return "\n".join(
        [
            f"## {node}",
            "",
            "| parameter | default | unit | allowed | meaning |",
            "|---|---|---|---|---|",
            *rows,
            "",
        ]
    )


def _yaml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        text = repr(value)
        # YAML 1.1 reads 1e-05 as text.
        return text if "." in text or "e" not in text else text.replace("e", ".0e")
    if isinstance(value, tuple):
        return str(list(value))
    return str(value) or '""'
