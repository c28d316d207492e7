"""Between a rig's integer codes and SI units.

Every channel of a rig, encoder, AD and DA alike, is one straight line:

    value = (code - zero) * per_code

``per_code`` carries the sign of the wiring. The nearest code is taken on the way back, limited
to what the converter can hold.
"""

from __future__ import annotations

from math import floor, pi
from typing import NamedTuple

# An encoder counts as far as the protocol's 32 bits.
LOWEST_COUNT, HIGHEST_COUNT = -(2**31), 2**31 - 1


class Channel(NamedTuple):
    """One channel: codes from ``low`` to ``high``, ``per_code`` [unit] each, ``zero`` [codes]."""

    per_code: float
    zero: float = 0.0
    low: int = LOWEST_COUNT
    high: int = HIGHEST_COUNT

    def to_si(self, code: int) -> float:
        """The value [unit] that ``code`` stands for."""
        return (code - self.zero) * self.per_code

    def to_code(self, value: float) -> int:
        """The code nearest to ``value`` [unit], within the converter's range."""
        return min(max(floor(value / self.per_code + self.zero + 0.5), self.low), self.high)

    def at_rail(self, code: int) -> bool:
        """Whether the converter can tell no more than that the value is beyond its range."""
        return not self.low < code < self.high


def converter(full_scale: float, bits: int, sign: int, zero: float) -> Channel:
    """A converter of ±``full_scale`` [unit] with ``bits``, two's complement."""
    half = 2 ** (bits - 1)
    return Channel(sign * full_scale / half, zero, -half, half - 1)


def encoder(counts_per_turn: int, sign: int, zero: float) -> Channel:
    """An encoder with ``counts_per_turn``; values in [rad]."""
    return Channel(sign * 2.0 * pi / counts_per_turn, zero)


def wrapped(angle: float) -> float:
    """``angle`` [rad] in -π ≤ angle < π."""
    return angle - 2.0 * pi * floor(angle / (2.0 * pi) + 0.5)
