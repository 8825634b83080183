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


def _call_status(typingctx: Any, address: Any, arguments: Any) -> Any:
    kinds = list(arguments)
    if not all(kind in (types.int64, types.float64) for kind in kinds):
        raise TypeError(f"call_status takes int64 and float64 arguments, not {kinds}")
    signature = types.int32(types.int64, arguments)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        target, packed = args
        values = cgutils.unpack_tuple(builder, packed, len(kinds))
        function_type = ir.FunctionType(ir.IntType(32), [value.type for value in values])
        pointer = builder.inttoptr(target, ir.PointerType(function_type))
        return builder.call(pointer, values)

    return signature, generate


call_status: Callable[[int, tuple[int | float, ...]], int] = intrinsic(_call_status)
"""`int32 status = (*address)(*arguments)`; arguments is a tuple of int64 and float64."""


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
