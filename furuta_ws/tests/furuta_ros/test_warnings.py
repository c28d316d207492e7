"""A node's log is not flooded, and each kind of warning is heard."""

from __future__ import annotations

from typing import Any, NamedTuple

import pytest

from furuta_ros import node as nodes
from furuta_ros.node import FurutaNode


class NoParameters(NamedTuple):
    """Nothing to set."""


def test_one_warning_of_a_kind_in_its_period(ros: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another kind has a period of its own, and after the period there is a next one."""
    times = iter([0.0, 0.5, 0.6, 0.9, 1.0])
    said: list[str] = []
    node = FurutaNode("warned", NoParameters)
    log: Any = type("Log", (), {"warning": staticmethod(said.append)})
    monkeypatch.setattr(nodes, "monotonic", lambda: next(times))
    monkeypatch.setattr(node, "get_logger", lambda: log)
    for kind in ("late", "late", "refused", "late", "late"):
        node.warn(kind, kind)
    node.destroy_node()
    assert said == ["late", "refused", "late"]
