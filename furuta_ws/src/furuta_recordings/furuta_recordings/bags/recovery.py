"""What is left of a broken bag, as a new one."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.damaged_files import DamagedError, salvage
from furuta_recordings.bags.mcap_file import Kind
from furuta_recordings.bags.writer import BagWriter
from furuta_recordings.recorder_node import PARAMETERS_FILE


def recover(bag: Path, out: Path) -> dict[str, object]:
    """Write what can be read of ``bag`` (directory or file) into a new bag ``out``."""
    files = sorted(
        (
            file
            for file in ([bag] if bag.is_file() else bag.iterdir() if bag.is_dir() else [])
            if file.suffix in (".mcap", ".db3")
        ),
        key=lambda file: (len(file.name), file.name),  # bag_2 before bag_10
    )
    if not files:
        raise ParameterError(f"{bag} holds no .mcap and no .db3 file: nothing to recover")
    if out.exists():
        raise ParameterError(f"{out} exists already; name another directory for the bag")
    reasons: list[str] = []
    kinds = _kinds(files, reasons)
    if not kinds:
        raise ParameterError(f"{bag} holds nothing that can be read as a bag")
    kept = bag / PARAMETERS_FILE
    parameters = {PARAMETERS_FILE: kept.read_text(errors="replace")} if kept.is_file() else {}
    writer = BagWriter(out, kinds, parameters)
    place = {(kind.topic, kind.type_name): index for index, kind in enumerate(kinds)}
    messages = 0
    for found in salvage(files, reasons):
        index = place.get((found.kind.topic, found.kind.type_name))
        if index is not None:
            writer.add(index, found.time, found.data)
            messages += 1
    writer.close()
    return {"bag": str(out), "messages": messages, "problems": reasons}


def _kinds(files: list[Path], reasons: list[str]) -> list[Kind]:
    """Topics of all messages whose type is known, in the order of their first ones."""
    kinds: dict[tuple[str, str], Kind] = {}
    for found in salvage(files, []):
        kinds.setdefault((found.kind.topic, found.kind.type_name), found.kind)
    sound = []
    for kind in kinds.values():
        try:
            sound.append(kind._replace(definition=_definition(kind)))
        except DamagedError as broken:
            reasons.append(f"left out {kind.topic}: {broken}")
    return sound


def _definition(kind: Kind) -> str:
    """The definition of a topic's type: as the bag has it if that is sound, or ROS's own."""
    if kind.definition:
        with suppress(Exception):  # whatever a parser raises
            get_types_from_msg(kind.definition, kind.type_name)
            return kind.definition
    types = get_typestore(Stores.ROS2_JAZZY)
    if kind.type_name not in types.types:
        raise DamagedError(f"nothing defines its type {kind.type_name!r}")
    return types.generate_msgdef(kind.type_name, ros_version=2)[0]
