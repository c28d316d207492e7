"""Conversion between a rig's integer codes and SI units.

Every channel of a rig (encoder, AD converter, DA converter) is linear:

    value = (code - zero) * per_code

``per_code`` carries the sign of the wiring. A value is converted to the nearest code within the
converter's range.
"""

from math import floor, pi
from typing import NamedTuple

# The protocol transmits encoder counts in 32 bits.
LOWEST_COUNT, HIGHEST_COUNT = -(2**31), 2**31 - 1


class Channel(NamedTuple):
    """One channel: codes from ``low`` to ``high``, ``per_code`` [unit] each, ``zero`` [codes]."""

    per_code: float
    zero: float = 0.0
    low: int = LOWEST_COUNT
    high: int = HIGHEST_COUNT

    def to_si(self, code: int) -> float:
        """Convert a code to its value [unit]."""
        return (code - self.zero) * self.per_code

    def to_code(self, value: float) -> int:
        """Convert a value [unit] to the nearest code within the converter's range."""
        return min(max(floor(value / self.per_code + self.zero + 0.5), self.low), self.high)

    def at_rail(self, code: int) -> bool:
        """Whether the code is at an end of the converter's range, so that the value is unknown."""
        return not self.low < code < self.high


def converter(full_scale: float, bits: int, sign: int, zero: float) -> Channel:
    """Make the channel of a converter of ±``full_scale`` [unit], ``bits`` in two's complement."""
    half = 2 ** (bits - 1)
    return Channel(sign * full_scale / half, zero, -half, half - 1)


def encoder(counts_per_turn: int, sign: int, zero: float) -> Channel:
    """Make the channel of an encoder with ``counts_per_turn``; its values are in [rad]."""
    return Channel(sign * 2.0 * pi / counts_per_turn, zero)


def wrapped(angle: float) -> float:
    """Wrap an angle [rad] to -π ≤ angle < π."""
    return angle - 2.0 * pi * floor(angle / (2.0 * pi) + 0.5)
