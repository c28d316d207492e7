"""Recordings that are killed: the bag is recovered, and at most a second is lost.

``FURUTA_KILLS=50`` kills that many; ``--capture=no`` prints what each has lost.
"""

import os
from pathlib import Path
from time import monotonic, sleep, time_ns
from typing import Any

import pytest

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import Bag
from furuta_recordings.bags.recovery import recover
from furuta_recordings.bags.writer import FLUSH_INTERVAL

KILLS = int(os.environ.get("FURUTA_KILLS", "2"))
# Size of the file [bytes] below which it is killed: from none to two seconds at 1 kHz.
LARGEST = 1_500_000
# After that, kills spread evenly over the time between two flushes.
GOLDEN_RATIO = 0.618
# Most time [s] that may be lost.
MOST_LOST = 1.0


def wait_for_size(bag: Path, size: int) -> None:
    """Wait until the file of a bag has that many bytes, and a chunk."""
    file, deadline = bag / f"{bag.name}_0.mcap", monotonic() + 120.0
    while not file.exists() or file.stat().st_size < max(size, 1000):
        assert monotonic() < deadline
        sleep(0.005)


@pytest.mark.long
@pytest.mark.timeout(300 + 20 * KILLS)
def test_sigkill_of_a_recording(processes: Any, tmp_path: Path) -> None:
    """Less than a second lies between the last message and the kill.

    That is more than what is lost: the time of a stalled machine counts against the recorder.
    """
    for k in range(KILLS):
        bag, recovered = tmp_path / f"bag{k}", tmp_path / f"recovered{k}"
        process = processes.furuta("run", "--record", bag)
        wait_for_size(bag, LARGEST * k // KILLS)
        sleep(FLUSH_INTERVAL * (GOLDEN_RATIO * k % 1.0))
        killed = time_ns()
        process.kill()
        process.communicate()
        with pytest.raises(ParameterError, match="`furuta bag recover`"), Bag(bag):
            pass
        messages = recover(bag, recovered)["messages"]
        with Bag(recovered) as opened:
            assert opened.message_count == messages
            lost = (killed - opened.start) / 1e9 - opened.seconds
        print(f"{messages} messages kept, at most {lost:.3f} s lost")
        assert lost <= MOST_LOST
