"""Copies the complete messages of a damaged MCAP bag into a new bag."""

import shutil
from collections.abc import Iterator
from pathlib import Path

from mcap.records import Channel, Chunk, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import parameter_file_of
from furuta_recordings.bags.metadata import BagTopic
from furuta_recordings.bags.writer import BagWriter


def recover(bag: Path, out: Path) -> dict[str, object]:
    """Copy the complete messages of ``bag`` (directory or file) into a new bag ``out``.

    The result has the keys bag, messages and problems (why the rest was left out).
    """
    files = [bag] if bag.is_file() else sorted(bag.glob("*.mcap"), key=_number)
    if not files or files[0].suffix != ".mcap":
        raise ParameterError(
            f"{bag} has no .mcap file: nothing to recover; the command `.recover` of sqlite3 "
            "copies a damaged .db3 file"
        )
    parameters = parameter_file_of(bag)
    texts = (
        {parameters.name: parameters.read_text(encoding="utf-8", errors="replace")}
        if parameters
        else {}
    )
    writer, problems = BagWriter(out, [], texts), list[str]()
    messages = sum(_copy(file, writer, problems) for file in files)
    writer.close()
    if not messages:
        shutil.rmtree(out)
        reason = "".join(f" ({problem})" for problem in problems[:1])
        raise ParameterError(f"{bag} has no message that can be read{reason}")
    return {"bag": str(out), "messages": messages, "problems": problems}


def _number(file: Path) -> tuple[int, str]:
    """Sorts bag_2 before bag_10."""
    return len(file.name), file.name


def _copy(file: Path, writer: BagWriter, problems: list[str]) -> int:
    """Copy the messages of a file; returns how many there are."""
    schemas: dict[int, Schema] = {}
    topics: dict[int, int] = {}  # indexes in the new bag by the number of the channel
    count = 0
    for record in _records(file, problems):
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel) and record.schema_id in schemas:
            topics[record.id] = writer.add_topic(_topic(record, schemas[record.schema_id]))
        elif isinstance(record, Message) and record.channel_id in topics:
            writer.add(topics[record.channel_id], record.log_time, record.data)
            writer.flush()
            count += 1
    return count


def _topic(channel: Channel, schema: Schema) -> BagTopic:
    about = channel.metadata
    return BagTopic(
        channel.topic,
        schema.name,
        schema.data.decode(errors="replace"),
        about.get("offered_qos_profiles", ""),
        about.get("topic_type_hash", ""),
        schema.encoding,
    )


def _records(file: Path, problems: list[str]) -> Iterator[McapRecord]:
    """The complete records of a file, those in chunks included; notes what is damaged."""
    with file.open("rb") as stream:
        try:
            for record in StreamReader(stream, emit_chunks=True).records:
                if isinstance(record, Chunk):
                    yield from _inner(record, file, problems)
                else:
                    yield record
        except Exception as error:  # a reader of damaged data may raise anything
            problems.append(f"{file.name}: ends with an incomplete record ({type(error).__name__})")


def _inner(chunk: Chunk, file: Path, problems: list[str]) -> list[McapRecord]:
    try:
        return breakup_chunk(chunk, validate_crc=True)
    except Exception as error:  # a decompressor may raise anything
        problems.append(f"{file.name}: left out a chunk that cannot be read ({error})")
        return []
