"""Public names that are imported when they are first used."""

import ast
from pathlib import Path


def public_names(file: str) -> dict[str, str]:
    """The module of each name that a file imports as itself: ``from m import name as name``.

    Type checkers read these lines, which do not run.
    """
    return {
        name.name: str(node.module)
        for node in ast.walk(ast.parse(Path(file).read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom)
        for name in node.names
        if name.asname
    }
