"""Campaign ``full_disk``: recordings whose disk becomes full.

As root the bag is on a small file system in memory. Otherwise the size of its files is limited.
"""

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from furuta_graph.processes import executable
from furuta_recordings.bags.bag import Bag
from soak.oracles import unexplained_end
from soak.record import Record
from soak.resources import ResourceMonitor

# Sizes of a disk in kB, from one that cannot hold a bag to one that holds a second.
SIZES = (16, 200, 1000, 3000)
LONGEST = 120.0  # [s] for a recording to end
SECONDS = "6"  # of simulated time


def run(record: Record, watch: ResourceMonitor) -> None:
    """Run the slice."""
    random = record.part.random()
    while record.next_step():
        size = int(random.choice(SIZES) * random.uniform(0.5, 1.5))
        with TemporaryDirectory() as directory, small_disk(Path(directory), size) as mounted:
            _record_until_full(record, Path(directory) / "bag", 0 if mounted else size)
        watch.sample({"full_disk": os.getpid()})


@contextmanager
def small_disk(directory: Path, size: int) -> Iterator[bool]:
    """Mount a file system of so many kB; yields False if this process must not."""
    options = ["-t", "tmpfs", "-o", f"size={size}k", "tmpfs", str(directory)]
    mounted = subprocess.run(["mount", *options], capture_output=True, check=False).returncode == 0
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", "--lazy", str(directory)], check=True)


def _record_until_full(record: Record, bag: Path, limit: int) -> None:
    """Record; the graph must run to its end, say why the recording ended, and leave a good bag."""
    furuta = [str(executable("furuta_bringup", "furuta")), "run", "--lockstep"]
    process = subprocess.Popen(
        [*_limited(limit), *furuta, "--seconds", SECONDS, "--record", str(bag)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        out, _ = process.communicate(timeout=LONGEST)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        record.check("recording", f"did not end within {LONGEST:g} s")
        return
    record.check("survival", unexplained_end(process.returncode or None, out))
    reported = "recording ended" in out or "error: " in out
    complete = process.returncode == 0 and not reported
    record.check("recording", unreadable(bag, complete))


def unreadable(bag: Path, complete: bool) -> str:
    """Whether the bag can be read; an incomplete one may be missing."""
    if not any(bag.glob("*.db3")):
        return "no bag" if complete else ""
    try:
        with Bag(bag) as opened:
            count = sum(1 for _ in opened.messages())
    except Exception as error:
        return f"unreadable: {type(error).__name__}: {error}"
    return f"complete, but {count} messages" if complete and count == 0 else ""


def _limited(size: int) -> list[str]:
    """The begin of a command whose files are limited to so many kB; 0 for no limit."""
    return ["bash", "-c", f'ulimit -f {size}; exec "$@"', "bash"] if size else []
