"""Many strings or binaries in one call: bound once, with memory of their own."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.values import binaries, binary_pointers
from harness.fmi.description.model_description import Variable


class TextGroup:
    """String or binary variables of an instance, the elements of arrays one after the other."""

    def __init__(self, instance: FmuInstance, variables: Sequence[Variable]) -> None:
        """Bind the group; all variables must be read and set by the same functions."""
        self.instance = instance
        self.suffix, ctype = instance.accessor(variables[0])
        self.is_binary = self.suffix == "Binary"
        total = sum(instance.count(v) for v in variables)
        self._references = (ctypes.c_uint32 * len(variables))(
            *(v.value_reference for v in variables)
        )
        self._sizes = (ctypes.c_size_t * total)()
        self._data: Any = ((ctypes.c_void_p if self.is_binary else ctype) * total)()
        blocks = [self._sizes, self._data] if self.is_binary else [self._data]
        pointers = [ctypes.c_void_p(ctypes.addressof(b)) for b in (self._references, *blocks)]
        sizes = [ctypes.c_size_t(total)] if instance.prefix == "fmi3" else []
        count = ctypes.c_size_t(len(variables))
        self._arguments = (pointers[0], count, *pointers[1:], *sizes)
        self._what = f" of {', '.join(v.name for v in variables[:3])}"

    def read(self) -> list[str] | list[bytes]:
        """The elements of all variables."""
        self.instance.call(f"Get{self.suffix}", *self._arguments, what=self._what)
        if self.is_binary:
            return binaries(self._sizes, self._data)
        return [(item or b"").decode("utf-8", "replace") for item in self._data]

    def write(self, values: Sequence[str | bytes]) -> None:
        """Set all elements, given in the order of the group."""
        data = [one.encode() if isinstance(one, str) else one for one in values]
        if self.is_binary:
            sizes, pointers, buffers = binary_pointers(data)
            self._sizes[:], self._data[:] = sizes, pointers
        else:
            self._data[:] = buffers = data
        self.instance.call(f"Set{self.suffix}", *self._arguments, what=self._what)
        del buffers  # which the call has read
