"""Writes rig files: every value that differs from the paper's rig, and the uncertainty."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import yaml

from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import UNCERTAINTY
from furuta_hw.rigs.uncertainty import Uncertainty, uncertainty_section
from furuta_model.parameters import values

# Sections that are written even if they agree with the paper's rig.
ALWAYS = ("model", "friction", "poles")


def rig_file_text(
    rig: Rig, uncertainty: Uncertainty, name: str, comments: Iterable[str] = ()
) -> str:
    """The text of a rig file; ``comments`` come first, one a line."""
    head = "".join(f"# {' '.join(each.split())}\n" for each in comments)
    content: dict[str, Any] = {"name": name, **_sections(rig)}
    if uncertainty.names:
        content[UNCERTAINTY] = uncertainty_section(uncertainty)
    return head + yaml.safe_dump(
        content, sort_keys=False, allow_unicode=True, width=100, default_flow_style=None
    )


def _sections(rig: Rig) -> dict[str, dict[str, Any]]:
    """The values that differ from the paper's, by section; numbers with nine digits."""
    default, sections = values(Rig()), dict[str, dict[str, Any]]()
    for full, value in values(rig).items():
        section, _, name = full.partition(".")
        if section in ALWAYS or value != default[full]:
            sections.setdefault(section, {})[name] = _rounded(value)
    return sections


def _rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value
