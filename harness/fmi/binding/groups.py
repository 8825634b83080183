"""Variables that the same C functions get and set, in one call with memory of their own."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

from harness.fmi.description.model_description import Variable


class Group:
    """Variables of one C type, the elements of arrays one after the other; `tell` receives what is
    wrong with texts that were read."""

    tell: Callable[[str], None]

    def __init__(
        self,
        call: Callable[..., None],
        suffix: str,
        ctype: Any,
        variables: Sequence[Variable],
        count: int,
        *,
        sized: bool,
    ) -> None:
        """`call` calls a function of the instance, `Get` or `Set` with `suffix`; all variables
        have `count` elements together, which is an argument where `sized`."""
        self._call, self._suffix = call, suffix
        self._references = (ctypes.c_uint32 * len(variables))(
            *(v.value_reference for v in variables)
        )
        self._sizes = (ctypes.c_size_t * count)()
        self._data: Any = ((ctypes.c_void_p if self._binary else ctype) * count)()
        blocks = (self._sizes, self._data) if self._binary else (self._data,)
        first, *pointers = (
            ctypes.c_void_p(ctypes.addressof(b)) for b in (self._references, *blocks)
        )
        sizes = (ctypes.c_size_t(count),) if sized else ()
        self._arguments = (first, ctypes.c_size_t(len(variables)), *pointers, *sizes)
        names = ", ".join(repr(v.name) for v in variables[:3])
        self._what = f" of variable{'s' * (len(variables) > 1)} {names}"

    @property
    def _binary(self) -> bool:
        return self._suffix == "Binary"

    def read(self) -> list[Any]:
        """The elements of all variables; texts and binaries are copied, since they are the FMU's
        own."""
        self._call(f"Get{self._suffix}", *self._arguments, what=self._what)
        if self._binary:
            places = zip(self._sizes, self._data, strict=True)
            return [ctypes.string_at(place, n) if place and n else b"" for n, place in places]
        if self._suffix == "String":
            return list(map(self._text, self._data))
        return list(self._data)

    def _text(self, item: bytes | None) -> str:
        if item is None:
            self.tell(
                f"a null pointer instead of a string was read{self._what}; it is taken for ''"
            )
            return ""
        try:
            return item.decode()
        except UnicodeDecodeError:
            self.tell(f"a string that is not UTF-8 was read{self._what}; '\ufffd' replaces bytes")
            return item.decode("utf-8", "replace")

    def write(self, values: Sequence[Any]) -> None:
        """Set all elements, given in the order of the group."""
        data = [one.encode() if isinstance(one, str) else one for one in values]
        if self._binary:
            buffers = [ctypes.create_string_buffer(one, max(1, len(one))) for one in data]
            self._sizes[:], data = list(map(len, data)), list(map(ctypes.addressof, buffers))
        self._data[:] = data
        self._call(f"Set{self._suffix}", *self._arguments, what=self._what)
