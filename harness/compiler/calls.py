"""Calling C functions by address from compiled code.

An address arrives as an int64 argument, so the code that calls it can be cached on disk. Pointers
and integers travel as int64, reals as double, and the C function returns an int32 status; on all
platforms served here an int64 in a register or stack slot is a valid pointer, size_t, int32 or
bool argument.

This module refuses to check addresses: whoever builds the program answers for them.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic  # type: ignore[untyped-decorator]
def call_status(typingctx: Any, address: Any, arguments: Any) -> Any:
    """`int32 status = (*address)(*arguments)`; arguments is a tuple of int64 and float64."""
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


@intrinsic  # type: ignore[untyped-decorator]
def load_int64(typingctx: Any, address: Any) -> Any:
    """The int64 that lies at `address`."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.load(builder.inttoptr(args[0], ir.PointerType(ir.IntType(64))))

    return types.int64(types.int64), generate
