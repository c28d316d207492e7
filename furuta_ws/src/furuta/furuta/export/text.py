"""Comments, long lines and the unchanging parts of C."""

import inspect
import re
import textwrap
from pathlib import Path
from typing import Any

WIDTH = 100
# A space at which no line ends.
KEPT = "\0"


def comment(text: str, indent: str = "") -> str:
    """A comment."""
    within = text.replace("*/", "* /")
    lines = textwrap.wrap(within, WIDTH - len(indent) - 6, break_long_words=False)
    return "\n".join(
        f"{indent}{'/*' if i == 0 else ' *'} {line}{' */' if i == len(lines) - 1 else ''}"
        for i, line in enumerate(lines)
    )


def summary(described: Any) -> str:
    """The first paragraph of a docstring, without markup."""
    paragraph = (inspect.getdoc(described) or "").split("\n\n")[0]
    return re.sub(r":\w+:`([^`]*)`|``", r"\1", " ".join(paragraph.split()))


def wrapped(line: str) -> str:
    """A statement, on several lines if it is long."""
    indent = line[: len(line) - len(line.lstrip())]
    lines = textwrap.wrap(
        line,
        WIDTH,
        subsequent_indent=f"{indent}        ",
        break_long_words=False,
        break_on_hyphens=False,
    )
    return "\n".join(lines).replace(KEPT, " ")


def filled(template: str, **values: object) -> str:
    """A file of ``templates`` with each @name@ replaced by its value."""
    text = (Path(__file__).parent / "templates" / template).read_text(encoding="utf-8")
    return filled_text(text, **values)


def filled_text(text: str, **values: object) -> str:
    """A text with each @name@ replaced by its value."""
    return re.sub(r"@(\w+)@", lambda found: str(values[found[1]]), text)
