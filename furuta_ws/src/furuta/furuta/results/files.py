"""Files that were written."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from furuta.results.result import Result


@dataclass(frozen=True, repr=False)
class Files(Result):
    """Files that were written: their paths, and their size together."""

    files: list[Path]

    def _by_name(self) -> dict[str, Any]:
        """The ``files``, and their size in ``bytes``."""
        size = sum(file.stat().st_size for file in self.files)
        return {"files": list(map(str, self.files)), "bytes": size}
