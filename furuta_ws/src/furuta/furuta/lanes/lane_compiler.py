"""Lanes: many samples of the same compiled functions side by side, in one block of memory.

A block has a row for every number of a record and a column for every lane. A record is a named
tuple or a memory. Compiled code gets a :class:`LanesType`; ``lanes[i]`` has the fields of the
record, which can be read and written. The functions of a sample are therefore used in lanes as they
are. Neighbouring lanes are neighbours in memory, so the compiler turns a loop over the lanes into
vector instructions. It does so only if the loop has no call and no index that depends on a value,
and if the number of lanes is not a constant, for which it unrolls the loop instead. A loop of many
hundred instructions waits for each result, so it is split.

Numbers that are equal in all lanes and select what is computed, such as the kind of a friction law,
are constants of the block's type. Each combination of them is compiled for itself.
"""

import operator
from collections.abc import Callable, Iterable
from hashlib import sha256
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin, lower_getattr_generic, lower_setattr_generic
from numba.core.typing.templates import (
    AbstractTemplate,
    AttributeTemplate,
    infer_global,
    signature,
)
from numba.extending import (
    NativeValue,
    infer_getattr,
    models,
    register_model,
    typeof_impl,
    unbox,
)

from furuta_model.compiled import make_intrinsic
from furuta_model.parameters import fields_of

# Numbers in a line of the cache.
CACHE_LINE = 8
# Kinds of numbers; all take eight bytes.
REAL, INTEGER, TRUTH = "f", "i", "b"
_NUMBA = {REAL: types.float64, INTEGER: types.int64, TRUTH: types.boolean}
# The compiler's library, which comes with numba.
_ir: Any = cgutils.ir
_DOUBLE, _INTEGER = _ir.DoubleType(), _ir.IntType(64)

# A layout is (kind, ...): ("record", ((name, row, layout), ...)), ("array", shape, kind of number),
# ("number", kind) or ("constant", kind, value). Rows count from the record that holds the field.
Layout = tuple[Any, ...]
# Whether the number with these marks (those of its field) and value is a constant of the block.
IsConstant = Callable[[tuple[Any, ...], Any], bool]


class Lanes:
    """A block of ``width`` lanes of one layout; ``data`` (rows, width) holds the numbers."""

    def __init__(self, layout: Layout, rows: int, width: int) -> None:
        self.layout = layout
        self.width = width
        self.data = _aligned(rows * width).reshape(rows, width)

    @property
    def address(self) -> int:
        """Address of the first number."""
        return int(self.data.__array_interface__["data"][0])

    def rows(self, name: str) -> np.ndarray:
        """The numbers of a field (size, width)."""
        row, layout = field_of(self.layout, name)
        return self.data[row : row + rows_of(layout)]

    def values(self, name: str, lane: int) -> Any:
        """A field in a lane; a record is a tuple of its fields."""
        row, layout = field_of(self.layout, name)
        return _values(layout, self.data[row:, lane])


def _values(layout: Layout, numbers: np.ndarray) -> Any:
    if layout[0] == "record":
        return tuple(_values(inner, numbers[row:]) for _, row, inner in layout[1])
    if layout[1] == REAL:
        return float(numbers[0])
    return (int if layout[1] == INTEGER else bool)(numbers[:1].view(np.int64)[0])


def _aligned(size: int) -> np.ndarray:
    """Zeros that begin at a cache line: a vector that crosses two of them costs two accesses."""
    memory = np.zeros(size + CACHE_LINE)
    address = memory.__array_interface__["data"][0]  # `ctypes` would leave cyclic garbage
    first = -(address // memory.itemsize) % CACHE_LINE
    return memory[first : first + size]


def layout_of(
    value: Any, is_constant: IsConstant, marked: tuple[Any, ...] = ()
) -> tuple[Layout, int]:
    """The layout of a record, an array or a number, and the rows that it takes."""
    if fields := fields_of(value):
        inner = [
            layout_of(getattr(value, name), is_constant, found)[0] for name, _, found in fields
        ]
        return joined((name for name, _, _ in fields), inner)
    if isinstance(value, np.ndarray):
        return ("array", value.shape, _kind(value.flat[0])), value.size
    if is_constant(marked, value):
        return ("constant", _kind(value), value), 1
    return ("number", _kind(value)), 1


def joined(names: Iterable[str], layouts: Iterable[Layout]) -> tuple[Layout, int]:
    """The layout of a record with these fields, and the rows that it takes."""
    fields, rows = [], 0
    for name, layout in zip(names, layouts, strict=True):
        fields.append((name, rows, layout))
        rows += rows_of(layout)
    return ("record", tuple(fields)), rows


def rows_of(layout: Layout) -> int:
    """The rows that a layout takes; a constant keeps its row, so that all groups are alike."""
    if layout[0] == "record":
        return sum(rows_of(inner) for _, _, inner in layout[1])
    return int(np.prod(layout[1])) if layout[0] == "array" else 1


def numbers_of(value: Any) -> np.ndarray:
    """All numbers of a named tuple as doubles; the bits of an integer stay."""
    numbers: list[float] = []
    _append(numbers, value)
    return np.array(numbers)


def _kind(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return TRUTH
    return INTEGER if isinstance(value, (int, np.integer)) else REAL


def _append(numbers: list[float], values: Iterable[Any]) -> None:
    """Append all numbers in ``values``. Fast, because a batch does it for every loop."""
    for each in values:
        if type(each) is float:
            numbers.append(each)
        elif isinstance(each, tuple):
            _append(numbers, each)
        elif isinstance(each, np.ndarray):
            flat = each.ravel()
            numbers += (flat if flat.dtype.kind == "f" else _as_doubles(flat)).tolist()
        elif isinstance(each, (int, np.integer, np.bool_)):
            numbers.append(float(_as_doubles(np.array(each))))
        else:
            numbers.append(each)


def _as_doubles(integers: np.ndarray) -> np.ndarray:
    """Doubles with the bits of integers."""
    return integers.astype(np.int64).view(np.float64)


def field_of(layout: Layout, name: str) -> tuple[int, Layout]:
    """First row and layout of a field."""
    for field, row, inner in layout[1]:
        if field == name:
            return row, inner
    raise AttributeError(name)


class _BlockType(types.Type):  # type: ignore[misc]
    """Numba's type of a block or of a lane of it, named by a hash, because names end in symbols."""

    def __init__(self, layout: Layout, width: int) -> None:
        self.layout = layout
        self.width = width
        digest = sha256(repr((layout, width)).encode()).hexdigest()[:16]
        super().__init__(f"{type(self).__name__}_{digest}")


class LanesType(_BlockType):
    """Numba's type of a block."""


class LaneType(_BlockType):
    """Numba's type of a lane, of a record in it, or of an array in it."""


@register_model(LanesType)
@register_model(LaneType)
class _AddressModel(models.PrimitiveModel):  # type: ignore[misc]
    """A block, lane, record or array is the address of its first number."""

    def __init__(self, manager: Any, numba_type: Any) -> None:
        super().__init__(manager, numba_type, _DOUBLE.as_pointer())


@typeof_impl.register(Lanes)
def _type_of(block: Lanes, context: Any) -> LanesType:
    return LanesType(block.layout, block.width)


@unbox(LanesType)
def _unbox(numba_type: Any, block: Any, c: Any) -> NativeValue:
    number = c.pyapi.object_getattr_string(block, "address")
    address = c.pyapi.long_as_longlong(number)
    c.pyapi.decref(number)
    return NativeValue(c.builder.inttoptr(address, _DOUBLE.as_pointer()))


def _index_type(index: Any) -> Any:
    several = isinstance(index, types.BaseTuple)
    return types.UniTuple(types.intp, len(index)) if several else types.intp


def _widest_vectors(_: Any) -> Any:
    """Let the function that calls this use vectors as wide as the processor has them.

    For some processors the compiler prefers half the width, because wide vectors would slow down
    the code around them. A loop over lanes has none.
    """

    def generate(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        # llvmlite adds only attributes that it knows by name.
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.none(), generate


widest_vectors: Callable[[], None] = make_intrinsic(_widest_vectors)


@infer_global(operator.getitem)
class _GetItem(AbstractTemplate):  # type: ignore[misc]
    def generic(self, arguments: Any, _: Any) -> Any:
        block, index = arguments
        if isinstance(block, LanesType):
            return signature(LaneType(block.layout, block.width), block, types.intp)
        if isinstance(block, LaneType) and block.layout[0] == "array":
            return signature(_NUMBA[block.layout[2]], block, _index_type(index))
        return None


@infer_global(operator.setitem)
class _SetItem(AbstractTemplate):  # type: ignore[misc]
    def generic(self, arguments: Any, _: Any) -> Any:
        block, index, _value = arguments
        if isinstance(block, LaneType) and block.layout[:1] == ("array",):
            return signature(types.none, block, _index_type(index), _NUMBA[block.layout[2]])
        return None


@lower_builtin(operator.getitem, LanesType, types.intp)
def _lower_lane(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
    return builder.gep(arguments[0], [arguments[1]], inbounds=True)


@lower_builtin(operator.getitem, LaneType, types.intp)
def _lower_get(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
    block, index = arguments
    return _load(builder, sig.args[0].layout[2], _element(builder, sig.args[0], block, [index]))


@lower_builtin(operator.getitem, LaneType, types.UniTuple)
def _lower_get_many(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
    indices = cgutils.unpack_tuple(builder, arguments[1])
    return _load(
        builder, sig.args[0].layout[2], _element(builder, sig.args[0], arguments[0], indices)
    )


@lower_builtin(operator.setitem, LaneType, types.intp, types.Float)
def _lower_set(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
    block, index, value = arguments
    builder.store(value, _element(builder, sig.args[0], block, [index]))
    return context.get_dummy_value()


def _element(builder: Any, block: LaneType, address: Any, indices: list[Any]) -> Any:
    """Address of an array's element."""
    flat, *others = indices
    for index, size in zip(others, block.layout[1][1:], strict=True):
        flat = builder.add(builder.mul(flat, _INTEGER(size), flags=("nsw",)), index, flags=("nsw",))
    return builder.gep(
        address, [builder.mul(flat, _INTEGER(block.width), flags=("nsw",))], inbounds=True
    )


def _load(builder: Any, kind: str, address: Any) -> Any:
    if kind == REAL:
        return builder.load(address)
    bits = builder.load(builder.bitcast(address, _INTEGER.as_pointer()))
    return bits if kind == INTEGER else builder.icmp_signed("!=", bits, _INTEGER(0))


def _store(builder: Any, kind: str, address: Any, value: Any) -> None:
    if kind == REAL:
        builder.store(value, address)
    else:
        bits = builder.zext(value, _INTEGER) if kind == TRUTH else value
        builder.store(bits, builder.bitcast(address, _INTEGER.as_pointer()))


@infer_getattr
class _Attributes(AttributeTemplate):  # type: ignore[misc]
    key = LaneType

    def generic_resolve(self, lane: Any, name: str) -> Any:  # type: ignore[override]
        if lane.layout[0] != "record" or name not in [each[0] for each in lane.layout[1]]:
            return None
        _, inner = field_of(lane.layout, name)
        single = inner[0] in ("number", "constant")
        return _NUMBA[inner[1]] if single else LaneType(inner, lane.width)


@lower_getattr_generic(LaneType)
def _lower_attribute(context: Any, builder: Any, lane: LaneType, address: Any, name: str) -> Any:
    row, inner = field_of(lane.layout, name)
    if inner[0] == "constant":
        return context.get_constant(_NUMBA[inner[1]], inner[2])
    inner_address = builder.gep(address, [_INTEGER(row * lane.width)], inbounds=True)
    return _load(builder, inner[1], inner_address) if inner[0] == "number" else inner_address


@lower_setattr_generic(LaneType)
def _lower_set_attribute(context: Any, builder: Any, sig: Any, arguments: Any, name: str) -> None:
    row, inner = field_of(sig.args[0].layout, name)
    address = builder.gep(arguments[0], [_INTEGER(row * sig.args[0].width)], inbounds=True)
    _store(builder, inner[1], address, arguments[1])
