"""Finds the files of a bag, and refuses those that are not in it."""

import os
import stat
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.limits import MOST_TOPICS, DamagedError
from furuta_recordings.bags.metadata import METADATA_FILE, PARAMETERS_FILE, VERSION
from furuta_ros.yaml_files import read_yaml

_SECTION = "rosbag2_bagfile_information"


class BagFiles(NamedTuple):
    """The data files of a bag in their order, their compression, and topics (name, type)."""

    files: list[Path]
    compression: str = ""  # "file", "message", or empty
    topics: tuple[tuple[str, str], ...] = ()


def bag_files(bag: Path) -> BagFiles:
    """The files of a bag: those that its metadata.yaml names, or the file itself.

    Raises:
        DamagedError: A file is missing, or is not a regular file in the bag.
        ParameterError: metadata.yaml cannot be read.
    """
    if not bag.is_dir():
        if not bag.is_file():
            raise DamagedError("it is a device or pipe")
        return BagFiles([bag])
    about = _information(read_yaml(file_in(bag, METADATA_FILE), "metadata"))
    names = [str(name) for name in _list(about, "relative_file_paths")]
    if len(set(names)) < len(names):
        raise DamagedError("its metadata names a file twice")
    return BagFiles(
        [file_in(bag, name) for name in names], _compression(about), tuple(_topics(about))
    )


def file_in(bag: Path, name: str) -> Path:
    """A regular file of a bag; ``name`` as its metadata gives it.

    Early rosbag2 put the name of the bag before that of the file.
    """
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or "\0" in name:
        raise DamagedError(f"its metadata names {name}, which is outside the bag")
    file = bag / path.name
    if not os.path.lexists(file):
        raise DamagedError(f"it has no file {path.name}")
    if not file.resolve().is_relative_to(bag.resolve()):
        raise DamagedError(f"{path.name} is a link to a file outside the bag")
    if not stat.S_ISREG(file.stat().st_mode):
        raise DamagedError(f"{path.name} is not a regular file")
    return file


def parameter_file_of(bag: Path) -> Path | None:
    """The parameter file beside the data, if there is one."""
    if not os.path.lexists(bag / PARAMETERS_FILE):
        return None
    try:
        return file_in(bag, PARAMETERS_FILE)
    except DamagedError as damage:
        raise ParameterError(f"{bag}: {damage}") from None


def _information(content: Any) -> Mapping[str, Any]:
    about = content.get(_SECTION) if isinstance(content, Mapping) else None
    if not isinstance(about, Mapping):
        raise DamagedError(f"its metadata has no {_SECTION}")
    version = about.get("version")
    if not isinstance(version, int) or version > VERSION:
        raise DamagedError(f"its metadata has version {version}, at most {VERSION} is known")
    return about


def _compression(about: Mapping[str, Any]) -> str:
    mode = str(about.get("compression_mode") or "none").lower()
    method = about.get("compression_format")
    if mode not in ("none", "file", "message") or (mode != "none" and method != "zstd"):
        raise DamagedError(f"compression {method} of each {mode} is not known, only zstd is")
    return "" if mode == "none" else mode


def _topics(about: Mapping[str, Any]) -> list[tuple[str, str]]:
    described = [_mapping(each, "topic_metadata") for each in _list(about, _TOPICS)]
    if len(described) > MOST_TOPICS:
        raise DamagedError(f"its metadata has more than {MOST_TOPICS} topics")
    return [(str(each.get("name")), str(each.get("type"))) for each in described]


_TOPICS = "topics_with_message_count"


def _list(about: Mapping[str, Any], name: str) -> list[Any]:
    found = about.get(name) or []
    if not isinstance(found, list):
        raise DamagedError(f"{name} in its metadata is not a list")
    return found


def _mapping(content: Any, name: str) -> Mapping[str, Any]:
    found = content.get(name) if isinstance(content, Mapping) else None
    if not isinstance(found, Mapping):
        raise DamagedError(f"{name} in its metadata has no content")
    return found
