"""Many variables of one type in one call: bound once, with memory of their own."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np

from harness.errors import FmuError
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.values import binaries, binary_pointers
from harness.fmi.description.model_description import Variable


class VariableGroup:
    """Variables of an instance that share the functions for their type, in one block of memory.

    `data` holds their elements one after the other; `places` maps a name to its slice of them.
    """

    def __init__(self, instance: FmuInstance, variables: Sequence[Variable]) -> None:
        """Bind the group; all variables must be read and set by the same functions."""
        self.instance = instance
        self.variables = tuple(variables)
        self.suffix, ctype = instance.accessor(self.variables[0])
        counts = [instance.count(v) for v in self.variables]
        ends = np.cumsum([0, *counts])
        self.places = {
            v.name: slice(int(a), int(b))
            for v, a, b in zip(self.variables, ends[:-1], ends[1:], strict=True)
        }
        total = int(ends[-1])
        self.is_binary, self.is_text = self.suffix == "Binary", self.suffix == "String"
        self._references = (ctypes.c_uint32 * len(counts))(
            *(v.value_reference for v in self.variables)
        )
        self._sizes = (ctypes.c_size_t * total)()
        self.data: Any = ((ctypes.c_void_p if self.is_binary else ctype) * total)()
        plain = not (self.is_binary or self.is_text)
        self.view: Any = (
            np.frombuffer(memoryview(self.data), dtype=ctype) if plain and total else None
        )
        self.signs = np.ones(total, dtype=np.int64)
        for v in self.variables:
            if v.details.negated:
                self.signs[self.places[v.name]] = -1
        self.negated = bool((self.signs < 0).any())
        self._arguments = self._bound_arguments()
        names = self.variables[0].name if len(counts) == 1 else f"{len(counts)} variables"
        self._what = f" of {names}"

    def _bound_arguments(self) -> tuple[Any, ...]:
        """What every call passes: all of it stays where it is."""
        sized = self.instance.prefix == "fmi3" and self.suffix != "Clock"
        blocks = [self._sizes, self.data] if self.is_binary else [self.data]
        pointers = [ctypes.c_void_p(ctypes.addressof(block)) for block in blocks]
        extra = [ctypes.c_size_t(len(self.data))] if sized else []
        references = ctypes.c_void_p(ctypes.addressof(self._references))
        return references, ctypes.c_size_t(len(self.variables)), *pointers, *extra

    def _call(self, verb: str) -> None:
        self.instance.call(f"{verb}{self.suffix}", *self._arguments, what=self._what)

    def read(self) -> Any:
        """The elements of all variables: a new array of numbers, or a list of str or bytes."""
        self._call("Get")
        if self.is_binary:
            return binaries(self._sizes, self.data)
        if self.is_text:
            return [(item or b"").decode("utf-8", "replace") for item in self.data]
        values = self.view.copy() if self.view is not None else np.zeros(0)
        return values * self.signs if self.negated else values

    def write(self, values: Sequence[Any]) -> None:
        """Set all elements, given in the order of the group."""
        buffers: Any = None
        try:
            if self.is_binary:
                sizes, pointers, buffers = binary_pointers(list(values))
                self._sizes[:], self.data[:] = sizes, pointers
            elif self.is_text:
                self.data[:] = [str(one).encode() for one in values]
            else:
                signs = self.signs.tolist() if self.negated else [1] * len(values)
                self.data[:] = [v * s if s < 0 else v for v, s in zip(values, signs, strict=True)]
        except (TypeError, ValueError, OverflowError) as fault:
            names, given = ", ".join(self.places), list(values)
            raise FmuError(
                f"component {self.instance.name}: {names} cannot be set to {given!r}: {fault}"
            ) from fault
        self._call("Set")
        del buffers  # which the call has read
