"""Reads 32-bit ELF files: machine code of the firmware, its sizes and symbols."""

import struct
from pathlib import Path
from typing import NamedTuple

# Kinds of sections, and flags.
SYMBOL_TABLE, NO_BITS = 2, 8
WRITABLE, ALLOCATED = 1, 2


class Section(NamedTuple):
    """A section header of a 32-bit ELF file."""

    name: int
    kind: int
    flags: int
    address: int
    offset: int
    size: int
    link: int
    info: int
    alignment: int
    entry: int


class Elf:
    """A 32-bit little-endian ELF file: what is loaded, sizes, and addresses of functions."""

    def __init__(self, path: Path) -> None:
        self._data = path.read_bytes()
        (offset,) = struct.unpack_from("<I", self._data, 32)
        size, count = struct.unpack_from("<HH", self._data, 46)
        self.sections = [
            Section(*struct.unpack_from("<10I", self._data, offset + k * size))
            for k in range(count)
        ]

    def loaded(self) -> list[tuple[int, bytes]]:
        """Address and content of what is in memory at the start, without zeros."""
        return [(s.address, self._content(s)) for s in self._allocated() if s.kind != NO_BITS]

    def code_size(self) -> int:
        """Code and constants [bytes]."""
        return sum(s.size for s in self._allocated() if s.kind != NO_BITS)

    def memory_size(self) -> int:
        """Static memory [bytes]."""
        return sum(s.size for s in self._allocated() if s.flags & WRITABLE)

    def functions(self) -> dict[str, int]:
        """Addresses of all symbols by name."""
        (table,) = (section for section in self.sections if section.kind == SYMBOL_TABLE)
        names = self._content(self.sections[table.link])
        symbols = struct.iter_unpack("<IIIBBH", self._content(table))
        return {names[at : names.index(b"\0", at)].decode(): value for at, value, *_ in symbols}

    def _allocated(self) -> list[Section]:
        return [section for section in self.sections if section.flags & ALLOCATED]

    def _content(self, section: Section) -> bytes:
        return self._data[section.offset : section.offset + section.size]
