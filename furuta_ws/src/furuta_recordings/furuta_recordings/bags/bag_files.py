"""The files of a bag: which there are, and what helps where they cannot be read."""

from pathlib import Path
from shlex import quote

from furuta_model.parameters import ParameterError
from furuta_recordings.bags.metadata import METADATA_FILE

SUFFIXES = (".mcap", ".db3")
# How files begin: those of bags, of bags of ROS 1, and compressed ones, which a command expands.
MAGIC = (b"\x89MCAP", b"SQLite format 3")
ROS_1 = b"#ROSBAG V"
COMPRESSED = {b"\x28\xb5\x2f\xfd": "zstd", b"\x1f\x8b": "gzip", b"BZh": "bzip2"}


def bag_files(bag: Path) -> list[Path]:
    """The files with the messages of a bag (directory or file), in their order."""
    if not bag.is_dir():
        return [bag]
    return sorted((file for file in bag.iterdir() if file.suffix in SUFFIXES), key=_number)


def _number(file: Path) -> tuple[int, str]:
    """Sorts bag_2 before bag_10."""
    return len(file.name), file.name


def is_bag(path: Path) -> bool:
    """Whether a path is that of a bag; raises for what must be converted first."""
    refuse_foreign(path)
    return path.is_dir() or path.suffix in SUFFIXES or _start(path).startswith(MAGIC)


def refuse_foreign(bag: Path) -> None:
    """Raise ParameterError for what must be converted first, with the command for it."""
    described = (bag / METADATA_FILE).is_file()  # its files may be compressed
    for file in () if described else bag_files(bag) or bag.iterdir():
        start, name = _start(file), quote(str(file))
        if start.startswith(ROS_1):
            new = quote(f"{file.with_suffix('')}_ros2")
            raise ParameterError(
                f"{file} is a ROS 1 bag; `rosbags-convert --src {name} --dst {new}` makes a ROS 2 "
                "bag of it"
            )
        for magic, tool in COMPRESSED.items():
            if start.startswith(magic):
                raise ParameterError(f"{file} is compressed; `{tool} -d {name}` expands it")


def advice(bag: Path) -> str:
    """What may help with a bag that cannot be read; empty if nothing is known to help."""
    suffixes = {file.suffix for file in bag_files(bag) if _start(file)}
    if ".mcap" in suffixes:
        return " (`furuta bag recover` copies what is still readable into a new bag)"
    if ".db3" in suffixes:
        index = f"`ros2 bag reindex {quote(str(bag))}` makes metadata.yaml anew; " * bag.is_dir()
        return f" ({index}the command `.recover` of sqlite3 copies a damaged .db3 file)"
    return ""


def _start(file: Path) -> bytes:
    """The first bytes of an ordinary file."""
    try:
        with file.open("rb") as stream:
            return stream.read(16) if file.is_file() else b""
    except OSError:  # whoever reads the file says why
        return b""
