"""Copies the complete messages of a damaged MCAP bag into a new bag."""

import shutil
from pathlib import Path

from mcap.records import Channel, Message, Schema

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.bag import parameter_file_of
from furuta_recordings.bags.bag_files import advice, bag_files, refuse_foreign
from furuta_recordings.bags.mcap_records import foreign, records
from furuta_recordings.bags.metadata import BagTopic
from furuta_recordings.bags.writer import BagWriter


def recover(bag: Path, out: Path) -> dict[str, object]:
    """Copy the complete messages of ``bag`` (directory or file) into a new bag ``out``.

    The result has the keys bag, messages and problems (why the rest was left out).
    """
    refuse_foreign(bag)
    files = [file for file in bag_files(bag) if file.suffix == ".mcap"]
    if not files:
        raise ParameterError(f"{bag} has no .mcap file: nothing to recover{advice(bag)}")
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


def _copy(file: Path, writer: BagWriter, problems: list[str]) -> int:
    """Copy the messages of a file; returns how many there are."""
    schemas: dict[int, Schema] = {}
    topics: dict[int, int] = {}  # indexes in the new bag by the number of the channel
    count = 0
    for record in records(file, problems):
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel) and (other := foreign(record)):
            problem = f"{file.name}: left out {record.topic}, whose {other}"
            problems += [] if problem in problems else [problem]
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
