"""Calling C functions by address from compiled code.

An address arrives as an int64 argument, so the code that calls it can be cached on disk. Pointers
and integers travel as int64, reals as double, and the C function returns an int32 status; on all
platforms served here an int64 in a register or stack slot is a valid pointer, size_t, int32 or
bool argument.

This module refuses to check addresses: whoever builds the program answers for them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


def calling(result: Any, returned: Any) -> Any:
    """An intrinsic that calls a function by address: its arguments are the address and a tuple of
    int64, int32 and float64; `result` is what C returns, `returned` what numba takes that for."""

    @intrinsic  # type: ignore[untyped-decorator]
    def call(typingctx: Any, address: Any, arguments: Any) -> Any:
        kinds = list(arguments)
        if not all(kind in (types.int64, types.int32, types.float64) for kind in kinds):
            raise TypeError(f"arguments are int64, int32 and float64, not {kinds}")

        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            target, packed = args
            values = cgutils.unpack_tuple(builder, packed, len(kinds))
            kind = ir.FunctionType(result, [value.type for value in values])
            found = builder.call(builder.inttoptr(target, ir.PointerType(kind)), values)
            return context.get_dummy_value() if returned == types.void else found

        return returned(types.int64, arguments), generate

    return call


call_status: Callable[[int, tuple[int | float, ...]], int] = calling(ir.IntType(32), types.int32)
"""`int32 status = (*address)(*arguments)`; arguments is a tuple of int64 and float64."""
call_outcome: Callable[[int, tuple[int | float, ...]], int] = calling(ir.IntType(64), types.int64)
"""The same of a function that returns an int64."""


def _load(kind: Any, numba_type: Any) -> Any:
    @intrinsic  # type: ignore[untyped-decorator]
    def load(typingctx: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.load(builder.inttoptr(args[0], ir.PointerType(kind)))

        return numba_type(types.int64), generate

    return load


def _store(kind: Any, numba_type: Any) -> Any:
    @intrinsic  # type: ignore[untyped-decorator]
    def store(typingctx: Any, address: Any, value: Any) -> Any:
        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            builder.store(args[1], builder.inttoptr(args[0], ir.PointerType(kind)))
            return context.get_dummy_value()

        return types.void(types.int64, numba_type), generate

    return store


load_int64: Callable[[int], int] = _load(ir.IntType(64), types.int64)
load_int32: Callable[[int], int] = _load(ir.IntType(32), types.int32)
load_uint8: Callable[[int], int] = _load(ir.IntType(8), types.uint8)
load_float64: Callable[[int], float] = _load(ir.DoubleType(), types.float64)
"""What lies at an address."""
store_int64: Callable[[int, int], None] = _store(ir.IntType(64), types.int64)
store_float64: Callable[[int, float], None] = _store(ir.DoubleType(), types.float64)
"""Write to an address."""


def _array(kind: Any) -> Any:
    @intrinsic  # type: ignore[untyped-decorator]
    def array(typingctx: Any, address: Any) -> Any:
        pointer = types.CPointer(kind)

        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.inttoptr(args[0], context.get_value_type(pointer))

        return pointer(types.int64), generate

    return array


reals: Callable[[int], Any] = _array(types.float64)
integers: Callable[[int], Any] = _array(types.int64)
octets: Callable[[int], Any] = _array(types.uint8)
"""The array at an address, which is indexed as in C: from 0, without a look at its end."""


@intrinsic  # type: ignore[untyped-decorator]
def _fixed(typingctx: Any, address: Any, place: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        start = builder.inttoptr(args[0], ir.PointerType(ir.IntType(64)))
        cell = builder.load(builder.gep(start, [args[1]]))
        cell.set_metadata("invariant.load", builder.module.add_metadata([]))
        return cell

    return types.int64(types.int64, types.int64), generate


fixed: Callable[[int, int], int] = _fixed
"""Element `place` of the int64 array at an address, which nothing changes while compiled code runs:
it may be read once and kept."""
