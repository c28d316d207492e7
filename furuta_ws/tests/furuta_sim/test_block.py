"""Blocks of parameters for compiled code."""

from typing import NamedTuple

import numpy as np

from furuta_model.block import block
from furuta_model.compiled import compiled


class Group(NamedTuple):
    """Numbers of each kind."""

    size: float
    on: bool
    count: int


class Outer(NamedTuple):
    """A group and an array."""

    inner: Group
    step: np.ndarray


@compiled
def sums(held: np.ndarray, x: np.ndarray) -> float:
    p = held[0]
    total = p.inner.size * p.inner.count if p.inner.on else 0.0
    return total + p.step[1, 0] * x[0]


def test_compiled_code_reads_every_kind() -> None:
    """Numbers, booleans, nested groups and arrays are read as they were written."""
    step = np.arange(6.0).reshape(2, 3)
    assert sums(block(Outer(Group(0.5, True, 4), step)), np.array([10.0])) == 2.0 + 30.0
    assert sums(block(Outer(Group(0.5, False, 4), step)), np.array([0.0])) == 0.0


def test_layout_is_that_of_the_types() -> None:
    """Other values of the same parameters cause no other compilation."""
    assert block(Group(1, True, 2)).dtype == block(Group(0.5, False, 3)).dtype
    assert block(Group(1, True, 2))["size"][0] == 1.0
