r"""Elementary functions without branches, which give the same bits alone and in many lanes.

The compiler turns a loop over many closed loops into vector instructions only if nothing in it
calls the C library. These functions are polynomials in fused multiply-adds, each of which is
rounded once. Their errors, in units in the last place (ulp), over the ranges below:

==================  =====================  ======
function            range                  error
==================  =====================  ======
:func:`exp`         −708 … 709             1.1
:func:`expm1`       −708 … 709             2.0
:func:`sin_cos`     −1e6 … 1e6             1.5
:func:`tanh`        all                    2.6
==================  =====================  ======

The polynomials are Taylor series on a reduced range, so their coefficients are those of any
textbook. The reduction is that of W. J. Cody and W. Waite, *Software Manual for the Elementary
Functions*, 1980. A NaN gives NaN.
"""

from collections.abc import Callable
from fractions import Fraction
from math import copysign, isfinite
from struct import pack, unpack
from typing import Any

from numba import types

from furuta_model.compiled import inlined, make_intrinsic

# Bits of a double's fraction, and what is added to its exponent.
FRACTION_BITS, BIAS = 52, 1023
# Adding and subtracting it rounds to an integer, which is then in the lowest bits [0 … 2⁵¹].
ROUND = 1.5 * 2.0**FRACTION_BITS
# 1/ln 2 and 2/π; ln 2 and π/2 as a double and what that leaves.
PER_LN2 = 1.4426950408889634
LN2, LN2_REST = 0.6931471805599453, 2.3190468138462996e-17
PER_QUARTER_TURN = 0.6366197723675814
QUARTER_TURN, QUARTER_TURN_REST = 1.5707963267948966, 6.123233995736766e-17
# Beyond these exp is no normal number.
LOWEST, HIGHEST = -708.0, 709.0
# tanh is 1 to rounding beyond.
SATURATED = 20.0


def _fma(_: Any, a: Any, b: Any, c: Any) -> Any:
    """a·b + c, rounded once."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), generate


def _bits_of(_: Any, x: Any) -> Any:
    """The bits of a double as an integer."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], context.get_value_type(types.int64))

    return types.int64(types.float64), generate


def _double_of(_: Any, bits: Any) -> Any:
    """The double with these bits."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], context.get_value_type(types.float64))

    return types.float64(types.int64), generate


def exact_fma(a: float, b: float, c: float) -> float:
    """a·b + c, rounded once, in Python; for finite numbers whose result is finite."""
    exact = Fraction(a) * Fraction(b) + Fraction(c) if isfinite(a * b + c) else None
    return float(exact) if exact else a * b + c


def _bits_in_python(x: float) -> int:
    (bits,) = unpack("<q", pack("<d", x))
    return int(bits)


def _double_in_python(bits: int) -> float:
    (x,) = unpack("<d", pack("<Q", int(bits) % 2**64))
    return float(x)


fma: Callable[[float, float, float], float] = make_intrinsic(_fma, exact_fma)
bits_of_double: Callable[[float], int] = make_intrinsic(_bits_of, _bits_in_python)
double_of_bits: Callable[[int], float] = make_intrinsic(_double_of, _double_in_python)


@inlined
def power_of_two(exponent: int) -> float:
    """2 to the power of an integer, −1022 … 1023."""
    return double_of_bits((exponent + BIAS) << FRACTION_BITS)


@inlined
def reduced_exponential(x: float) -> tuple[float, float, float]:
    """(r, (eʳ − 1 − r)/r², 2ᵏ) with x = k ln 2 + r, |r| ≤ ln 2 / 2; −708 ≤ x ≤ 709."""
    rounded = fma(x, PER_LN2, ROUND)
    k = rounded - ROUND
    r = fma(-k, LN2_REST, fma(-k, LN2, x))
    s = r * r
    # Σ rⁿ/n! from n = 2, odd and even powers separately, which takes half as long.
    even = fma(s, 1.0 / 87178291200.0, 1.0 / 479001600.0)
    even = fma(s, even, 1.0 / 3628800.0)
    even = fma(s, even, 1.0 / 40320.0)
    even = fma(s, even, 1.0 / 720.0)
    even = fma(s, even, 1.0 / 24.0)
    even = fma(s, even, 0.5)
    odd = fma(s, 1.0 / 6227020800.0, 1.0 / 39916800.0)
    odd = fma(s, odd, 1.0 / 362880.0)
    odd = fma(s, odd, 1.0 / 5040.0)
    odd = fma(s, odd, 1.0 / 120.0)
    odd = fma(s, odd, 1.0 / 6.0)
    scale = power_of_two(bits_of_double(rounded))
    return r, fma(r, odd, even), scale


@inlined
def within(x: float) -> float:
    """``x`` limited to where exp is a normal number; a NaN stays."""
    x = LOWEST if x < LOWEST else x
    return HIGHEST if x > HIGHEST else x


@inlined
def exp(x: float) -> float:
    """eˣ; 0 below −708, and e⁷⁰⁹ above 709."""
    r, curvature, scale = reduced_exponential(within(x))
    return 0.0 if x < LOWEST else fma(scale, fma(r * r, curvature, r), scale)


@inlined
def expm1(x: float) -> float:
    """eˣ − 1, accurate for small x too; e⁷⁰⁹ − 1 above 709."""
    r, curvature, scale = reduced_exponential(within(x))
    return fma(scale, fma(r * r, curvature, r), scale - 1.0)


@inlined
def sin_cos(x: float) -> tuple[float, float]:
    """Sine and cosine of ``x`` [rad]."""
    rounded = fma(x, PER_QUARTER_TURN, ROUND)
    k = rounded - ROUND
    r = fma(-k, QUARTER_TURN_REST, fma(-k, QUARTER_TURN, x))
    s = r * r
    sine = fma(s, -1.0 / 1307674368000.0, 1.0 / 6227020800.0)
    sine = fma(s, sine, -1.0 / 39916800.0)
    sine = fma(s, sine, 1.0 / 362880.0)
    sine = fma(s, sine, -1.0 / 5040.0)
    sine = fma(s, sine, 1.0 / 120.0)
    sine = fma(s, sine, -1.0 / 6.0)
    sine = fma(s * r, sine, r)
    cosine = fma(s, 1.0 / 20922789888000.0, -1.0 / 87178291200.0)
    cosine = fma(s, cosine, 1.0 / 479001600.0)
    cosine = fma(s, cosine, -1.0 / 3628800.0)
    cosine = fma(s, cosine, 1.0 / 40320.0)
    cosine = fma(s, cosine, -1.0 / 720.0)
    cosine = fma(s, cosine, 1.0 / 24.0)
    cosine = fma(s, fma(s, cosine, -0.5), 1.0)
    quarter = bits_of_double(rounded)
    odd = (quarter & 1) != 0
    first, second = (cosine, sine) if odd else (sine, cosine)
    first = -first if (quarter & 2) != 0 else first
    second = -second if ((quarter + 1) & 2) != 0 else second
    return first, second


@inlined
def tanh(x: float) -> float:
    """Tanh x."""
    size = abs(x)
    size = SATURATED if size > SATURATED else size
    grown = expm1(2.0 * size)
    return copysign(grown / (grown + 2.0), x)
