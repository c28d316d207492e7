"""The process that writes a bag from what a recorder sends through a pipe."""

import os
import sys
from contextlib import suppress
from pathlib import Path
from time import monotonic, sleep

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.pipe_protocol import (
    FRAME_HEAD,
    PIPE_CAPACITY,
    READY,
    complete_frames,
    parse_header,
)
from furuta_recordings.bags.writer import BagWriter

# Time [s] between two reads of the pipe, unless the last one returned more than SMALL_READ
# [bytes]. With it the recorder need not wake the writer.
READ_INTERVAL = 0.02
SMALL_READ = 2**16
# Time [s] between two flushes to the disk.
FLUSH_INTERVAL = 0.1


def main(path: Path) -> int:
    """Write what arrives on standard input until its end; returns the exit status."""
    # A batch process gets its share of the processor, but never preempts the control loop when it
    # wakes up. It must not inherit the loop's real-time priority either.
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    length, _, _ = FRAME_HEAD.unpack(_read_exactly(FRAME_HEAD.size))
    topics, parameters = parse_header(_read_exactly(length))
    try:
        writer = BagWriter(path, topics, parameters)
        print(READY, flush=True)
        _write_until_end(writer)
    except ParameterError as error:
        print(error, flush=True)
        return 1
    except OSError as error:
        print(f"{error.filename or path}: {error.strerror}", flush=True)
        return 1
    return 0


def _read_exactly(length: int) -> bytes:
    data = b""
    while len(data) < length:
        data += os.read(0, length - len(data)) or sys.exit(1)
    return data


def _write_until_end(writer: BagWriter) -> None:
    """Write frames until the other end of the pipe is closed, for whatever reason."""
    os.set_blocking(0, False)
    rest, flushed = b"", 0.0
    while (data := _read_available()) is not None:
        rest = _add_complete(writer, rest + data)
        if writer.pending_bytes and monotonic() - flushed >= FLUSH_INTERVAL:
            writer.flush()
            flushed = monotonic()
        if len(data) <= SMALL_READ:
            sleep(READ_INTERVAL)
    writer.close()


def _read_available() -> bytes | None:
    """What is in the pipe, perhaps nothing; None at its end."""
    try:
        return os.read(0, PIPE_CAPACITY) or None
    except BlockingIOError:
        return b""


def _add_complete(writer: BagWriter, data: bytes) -> bytes:
    """Give every complete frame to the writer; returns the incomplete rest."""
    end = 0
    for topic, time, content, frame_end in complete_frames(data):
        writer.add(topic, time, content)
        end = frame_end
    return data[end:]


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
