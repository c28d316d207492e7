"""Writes an MCAP file that is complete at every moment, even if the writing process is killed.

An MCAP file ends with a summary and a footer. If a writer is killed before it has written them,
readers refuse the file. Here summary and footer exist from the start, after reserved space for
data that takes no disk space until it is filled (a sparse file):

    header | chunks …  (reserved) | summary A | summary B | footer

Each flush writes a chunk into the reserved space and a new summary over the one that is not in
use. Readers use neither until the footer, 20 bytes in one disk block, points to the new summary.
Filler records, which readers skip as the format demands, span the unused space. ``close`` writes
summary and footer directly after the last chunk and cuts off the rest, which leaves an ordinary
file.
"""

from __future__ import annotations

import os
from pathlib import Path

from mcap.data_stream import RecordBuilder
from mcap.records import ChunkIndex, DataEnd, Statistics

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.mcap_chunk import PendingChunk
from furuta_recordings.bags.mcap_records import (
    FOOTER_SIZE,
    RECORD_HEAD,
    BagTopic,
    file_head,
    filler,
    footer,
)

# Space for data and for a summary [bytes]; if either is full, another file follows.
DATA_SPACE = 64 * 2**20
SUMMARY_SPACE = 2**20


class McapFile:
    """Collects messages (:meth:`add`) and writes them to the disk (:meth:`flush`).

    ``counts`` is the number of messages of each topic; ``start`` and ``end`` are the times [ns] of
    the first and last message on the disk.
    """

    def __init__(
        self, path: Path, topics: list[BagTopic], metadata: dict[str, dict[str, str]]
    ) -> None:
        self.path = path
        self.counts = [0] * len(topics)
        self.start, self.end = 2**63 - 1, 0
        self._pending = PendingChunk(len(topics))
        self._chunk_indexes = b""
        self._chunk_count = 0
        self._summaries_written = 0
        self._head = file_head(topics, metadata)
        if len(self._head.summary) > SUMMARY_SPACE // 2:
            raise ParameterError(
                f"{len(topics)} topics with {len(self._head.summary)} bytes of definitions, at "
                f"most {SUMMARY_SPACE // 2} bytes fit into a file"
            )
        self._data_end = len(self._head.data)
        part = path.with_name(path.name + ".new")
        self._file = os.open(part, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644)
        self._write(0, self._head.data + self._filler_after(self._data_end))
        os.ftruncate(self._file, DATA_SPACE + 2 * SUMMARY_SPACE + FOOTER_SIZE)
        self._update_summary()
        os.rename(part, path)

    @property
    def full(self) -> bool:
        """Whether only the messages that already wait are sure to fit."""
        return (
            self._data_end + 2 * self.pending_bytes + 2**20 > DATA_SPACE
            or len(self._chunk_indexes) > SUMMARY_SPACE // 2
        )

    @property
    def pending_bytes(self) -> int:
        """Size of the messages that are not on the disk yet [bytes]."""
        return self._pending.size

    def add(self, topic: int, time: int, data: bytes) -> None:
        """Keep a message of a topic (index), received at ``time`` [ns], until the next flush."""
        self._pending.add(topic, self.counts[topic], time, data)
        self.counts[topic] += 1

    def flush(self) -> None:
        """Write what was added; on :class:`OSError` the file stays as it was."""
        chunk = self._pending
        if not chunk.size:
            return
        data, entry = chunk.encoded(self._data_end)
        end = self._data_end + len(data)
        records = data + self._filler_after(end)
        # The head last: until then the filler record before hides an incomplete chunk from readers
        # that scan the data.
        self._write(self._data_end + RECORD_HEAD.size, records[RECORD_HEAD.size :])
        self._write(self._data_end, records[: RECORD_HEAD.size])
        self._data_end = end
        self._chunk_indexes += _encoded(entry)
        self._chunk_count += 1
        self.start, self.end = min(self.start, chunk.start), max(self.end, chunk.end)
        self._pending = PendingChunk(len(self.counts))
        self._update_summary()

    def close(self) -> None:
        """Write what is left, then cut off the unused space."""
        try:
            self.flush()
            data_end = _encoded(DataEnd(0))
            summary = self._summary()
            start = self._data_end + len(data_end)
            self._write(self._data_end, data_end + summary + footer(start))
            os.ftruncate(self._file, start + len(summary) + FOOTER_SIZE)
        finally:
            os.close(self._file)

    def _summary(self) -> bytes:
        statistics = Statistics(
            attachment_count=0,
            channel_count=len(self.counts),
            channel_message_counts={k + 1: n for k, n in enumerate(self.counts) if n},
            chunk_count=self._chunk_count,
            message_count=sum(self.counts),
            message_end_time=self.end,
            message_start_time=self.start if self._chunk_count else 0,
            metadata_count=self._head.metadata_count,
            schema_count=self._head.schema_count,
        )
        return self._head.summary + _encoded(statistics) + self._chunk_indexes

    def _update_summary(self) -> None:
        """Write a summary over the one that is not in use, then point the footer to it."""
        start = DATA_SPACE + (self._summaries_written % 2) * SUMMARY_SPACE
        self._summaries_written += 1
        summary = self._summary()
        footer_start = DATA_SPACE + 2 * SUMMARY_SPACE
        self._write(start, summary + filler(footer_start - start - len(summary)))
        self._write(footer_start, footer(start))

    def _filler_after(self, end: int) -> bytes:
        """Head of the record that fills the data space from ``end`` [bytes] on."""
        return filler(DATA_SPACE - end)

    def _write(self, offset: int, data: bytes) -> None:
        view = memoryview(data)
        while view:
            written = os.pwrite(self._file, view, offset)
            view, offset = view[written:], offset + written


def _encoded(record: ChunkIndex | DataEnd | Statistics) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()
