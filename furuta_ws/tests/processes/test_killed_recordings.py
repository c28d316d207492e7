"""Recordings that are killed: the bag is readable, and at most a second is lost.

``FURUTA_KILLS=50`` kills that many; ``--capture=no`` prints what each has lost.
"""

import json
import os
from pathlib import Path
from time import monotonic, sleep, time_ns
from typing import Any

import pytest

from furuta_recordings.bags.background_writer import FLUSH_INTERVAL
from furuta_recordings.bags.bag import Bag

KILLS = int(os.environ.get("FURUTA_KILLS", "2"))
# Messages in the bag below which it is killed: from none to two seconds at 1 kHz.
LATEST = 10_000
# After that, kills spread evenly over the time between two flushes.
GOLDEN_RATIO = 0.618
# Most time [s] that may be lost.
MOST_LOST = 1.0


def wait_for(file: Path) -> None:
    deadline = monotonic() + 120.0
    while not file.exists():
        assert monotonic() < deadline
        sleep(0.002)


def wait_for_messages(bag: Path, count: int) -> int:
    """Wait until a growing bag has ``count`` messages; returns how many there are."""
    deadline = monotonic() + 120.0
    while (number := len(recorded(bag))) < count:
        assert monotonic() < deadline
        sleep(0.005)
    return number


def recorded(bag: Path) -> list[int]:
    """Times of the messages [ns]."""
    with Bag(bag) as opened:
        return [time for _, time, _ in opened.messages()]


@pytest.mark.long
@pytest.mark.timeout(300 + 20 * KILLS)
def test_sigkill_of_a_recording(furuta: Any, processes: Any, tmp_path: Path) -> None:
    """What was in the bag stays, and less than a second lies between the last message and the kill.

    That is more than what is lost: the time of a stalled machine counts against the recorder.
    """
    for k in range(KILLS):
        bag, wanted = tmp_path / f"bag{k}", LATEST * k // KILLS
        process = processes.furuta("run", "--record", bag)
        wait_for(bag)
        appeared, seen = time_ns(), wait_for_messages(bag, wanted)
        sleep(FLUSH_INTERVAL * (GOLDEN_RATIO * k % 1.0))
        killed = time_ns()
        process.kill()
        process.communicate()
        kept = recorded(bag)
        lost = (killed - max(kept, default=appeared)) / 1e9
        print(f"{seen} messages seen, {len(kept)} kept, at most {lost:.3f} s lost")
        assert len(kept) >= seen
        assert lost <= MOST_LOST
        status, out, err = furuta("bag", "info", bag, "--json")
        assert status == 0, err
        assert json.loads(out)["messages"] <= len(kept)
