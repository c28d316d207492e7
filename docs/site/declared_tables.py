"""Tables of declared parameters, in Markdown: those of the nodes, and the keys of rig files."""

import re
from collections.abc import Iterable, Iterator
from typing import Any

from pictures import EXAMPLES, ROOT

import furuta
from furuta.figures.figure import SYMBOLS
from furuta.settings.nodes import NODES
from furuta_hw.rigs.physical import PhysicalParameters
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import LinearCoefficients
from furuta_hw.rigs.uncertainty import ABSOLUTE, RELATIVE
from furuta_model.parameters import About, Declared, declared


def table(heads: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """A table in Markdown."""
    first, *others = ["| " + " | ".join(map(str, line)) + " |" for line in (heads, *rows)]
    return "\n".join([first, "|" + "---|" * (first.count("|") - 1), *others])


def examples() -> str:
    """What each example says about itself, and the picture that it draws."""
    pictures = {example: name for name, example in EXAMPLES.items()} | {"nyquist": "nyquist.png"}
    parts = []
    for file in sorted((ROOT / "examples").glob("*.py")):
        about = file.read_text(encoding="utf-8").split('"""')[1].partition("\n\n")[0]
        script = f"[{file.name}](../../examples/{file.name})"
        parts += [f"## {file.stem}", f"{script}: {' '.join(about.split())}"]
        if picture := pictures.get(file.stem):
            parts.append(f"![What {file.stem} draws](../{picture})")
    return "\n\n".join(parts)


def library_row(name: str) -> tuple[str, str]:
    """A name of the library, with its link, and the first sentence of its description."""
    text = (getattr(furuta, name).__doc__ or "").strip().partition("\n")[0]
    return f"{{py:obj}}`~furuta.{name}`", re.sub(r":\w+:`", "`", text).replace("|", "\\|")


def parameters_of_nodes() -> str:
    """Every parameter of every node."""
    return "\n\n".join(
        f"## {node.name}\n\n{_parameters(declared(node.parameters))}" for node in NODES.values()
    )


def _parameters(rows: Iterable[Declared]) -> str:
    heads = ("name", "default", "unit", "allowed", "meaning")
    return table(heads, ((f"`{row.name}`", *_about(row, row.about.meaning)) for row in rows))


def _about(row: Declared, meaning: str) -> tuple[Any, ...]:
    default = f"{row.default:.6g}" if isinstance(row.default, float) else row.default
    plain = str(list(default) if isinstance(default, tuple) else default) or '""'
    start = "; at start only" if row.about.read_only else ""
    return plain, row.about.unit, row.about.allowed, meaning + start


def keys_of_rig_files() -> str:
    """The keys of each section."""
    sections: dict[str, list[Declared]] = {}
    for row in declared(Rig):
        sections.setdefault(row.name.partition(".")[0], []).append(row)
    sections["linear"] = list(declared(LinearCoefficients, "linear."))
    sections["physical"] = list(declared(PhysicalParameters, "physical."))
    return "\n\n".join(f"## {name}\n\n{_keys(name, rows)}" for name, rows in sections.items()) + (
        "\n\n## uncertainty\n\n`standard_errors` maps names to numbers, `correlations` is a lower "
        f"triangle.\n\nRelative: {', '.join(RELATIVE)}. arm_inertia is α − γ²/β.\n\n"
        f"In the unit of the value: {', '.join(ABSOLUTE)}.\n"
    )


def _keys(section: str, rows: list[Declared]) -> str:
    heads = ("key", "symbol", "default", "unit", "allowed", "meaning")
    return table(heads, _key_rows(section, rows))


def _key_rows(section: str, rows: list[Declared]) -> Iterator[tuple[Any, ...]]:
    for row in rows:
        key = row.name.partition(".")[2]
        symbol, meaning = _symbol(section, key, row.about)
        yield (f"`{key}`", symbol, *_about(row, meaning))


def _symbol(section: str, key: str, about: About) -> tuple[str, str]:
    """Symbol and meaning; the physical parameters have theirs in front of the meaning."""
    if section == "physical":
        symbol, _, meaning = about.meaning.partition(", ")
        return symbol, meaning or about.meaning
    return SYMBOLS.get(key, ""), about.meaning
