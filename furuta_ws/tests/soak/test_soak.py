"""A short slice of the soak finds nothing."""

import pytest

from soak.__main__ import run_slice
from soak.record import Slice


@pytest.mark.long
def test_a_short_slice_breaks_no_oracle() -> None:
    """A second or two of the campaign without processes, with a fixed seed."""
    record = run_slice(Slice("messages", 0, 1, 0.0, steps=4000))
    assert record.failures == []
    assert record.step == 4000
    assert record.checks.total() > 0
