"""An FMU by ctypes and xml.etree alone: what the oracle of these tests needs, and no more.

Nothing of the harness is used here, so that no fault of it can hide. One variable is read or set
at a time. `get` and `set` take numbers, booleans, texts and bytes, and lists of them for arrays.
"""

import ctypes as c
import tempfile
import zipfile
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

C_TYPES = {
    "Real": c.c_double, "Integer": c.c_int, "String": c.c_char_p, "Float64": c.c_double,
    "Float32": c.c_float, "Int8": c.c_int8, "UInt8": c.c_uint8, "Int16": c.c_int16,
    "UInt16": c.c_uint16, "Int32": c.c_int32, "UInt32": c.c_uint32, "Int64": c.c_int64,
    "UInt64": c.c_uint64, "Binary": c.c_char_p, "Clock": c.c_bool,
}  # fmt: skip
BOOLEANS = {"1": c.c_int8, "2": c.c_int, "3": c.c_bool}
LIBC = c.CDLL(None)
LOG = c.CFUNCTYPE(None, c.c_void_p, c.c_char_p, c.c_int, c.c_char_p, c.c_char_p)(lambda *_: None)
LOG3 = c.CFUNCTYPE(None, c.c_void_p, c.c_int, c.c_char_p, c.c_char_p)(lambda *_: None)


@dataclass(frozen=True)
class Variable:
    """`sizes` are numbers, or value references of the structural parameters that hold them."""

    reference: int
    type: str
    causality: str
    attributes: dict[str, str]
    negated: bool = False
    sizes: tuple[int | str, ...] = ()


class Callbacks1(c.Structure):
    _fields_ = [("functions", c.c_void_p * 4)]


class EventInfo1(c.Structure):
    _fields_ = [*((n, c.c_char) for n in ("converged", "references", "values", "terminate")),
                ("upcoming", c.c_char), ("next", c.c_double)]  # fmt: skip


class EventInfo2(c.Structure):
    _fields_ = [*((n, c.c_int) for n in ("needs", "terminate", "nominals", "values", "defined")),
                ("next", c.c_double)]  # fmt: skip


def read_root(path: Path) -> ET.Element:
    """The model description of the FMU at `path`."""
    with zipfile.ZipFile(path) as archive:
        return ET.fromstring(archive.read("modelDescription.xml"))


def read_variables(root: ET.Element) -> dict[str, Variable]:
    found = {}
    for element in root.find("ModelVariables") or ():
        value = element
        if element.tag == "ScalarVariable":
            value = next(e for e in element if e.tag not in ("Annotations", "DirectDependency"))
        reference = int(element.get("valueReference", ""))
        attributes = {**element.attrib, **value.attrib}
        sizes = [
            d.get("valueReference") or int(d.get("start", "")) for d in element.iter("Dimension")
        ]
        for name in [element, *element.findall("Alias")]:
            found[name.get("name", "")] = Variable(
                reference, value.tag, element.get("causality", "local"), attributes,
                element.get("alias") == "negatedAlias", tuple(sizes),
            )  # fmt: skip
    return found


class PlainFmu:
    """One instance of the FMU at `path`; `kind` as in `KINDS`. Leaving frees it."""

    def __init__(self, path: Path, kind: str, event_mode: bool = False) -> None:
        self.folder = tempfile.TemporaryDirectory()
        zipfile.ZipFile(path).extractall(self.folder.name)
        root = self.root = read_root(path)
        self.version, self.kind, self.event_mode = root.get("fmiVersion", "")[0], kind, event_mode
        self.variables = read_variables(root)
        self.sizes = {
            str(v.reference): int(v.attributes["start"])
            for v in self.variables.values()
            if v.causality == "structuralParameter" and v.type == "UInt64"
        }
        interface = {"co-simulation": "CoSimulation", "model-exchange": "ModelExchange",
                     "scheduled-execution": "ScheduledExecution"}[kind]  # fmt: skip
        one = root if self.version == "1" else root.find(interface)
        assert one is not None, f"{path} has no {kind}"
        identifier = one.get("modelIdentifier", "")
        self.prefix = f"{identifier}_fmi" if self.version == "1" else f"fmi{self.version}"
        place = Path(self.folder.name, "binaries")
        place /= "x86_64-linux" if self.version == "3" else "linux64"
        self.library = c.CDLL(str(place / f"{identifier}.so"))
        token = root.get("guid") or root.get("instantiationToken") or ""
        self.updates = 0  # calls of the FMU that say that clocks have changed
        self.handle = self._instantiate(interface, token.encode())
        assert self.handle.value, f"{path} was not instantiated"

    def _instantiate(self, interface: str, token: bytes) -> c.c_void_p:
        where = f"file://{self.folder.name}"  # of the whole FMU in FMI 1, of its resources in FMI 2
        where = (where if self.version == "1" else f"{where}/resources").encode()
        stepping = interface == "CoSimulation"
        if self.version == "1":
            self.callbacks: Any = Callbacks1((c.c_void_p * 4)(
                c.cast(LOG, c.c_void_p).value, c.cast(LIBC.calloc, c.c_void_p).value,
                c.cast(LIBC.free, c.c_void_p).value, None,
            ))  # fmt: skip
            if stepping:
                more = (
                    where,
                    b"",
                    c.c_double(),
                    c.c_char(),
                    c.c_char(),
                    self.callbacks,
                    c.c_char(),
                )
                return self._made("InstantiateSlave", b"plain", token, *more)
            three = (c.c_void_p * 3)(*self.callbacks.functions[:3])
            self.callbacks = type("Three", (c.Structure,), {"_fields_": [("f", c.c_void_p * 3)]})(
                three
            )
            return self._made("InstantiateModel", b"plain", token, self.callbacks, c.c_char())
        if self.version == "2":
            functions = [c.cast(f, c.c_void_p).value for f in (LOG, LIBC.calloc, LIBC.free)]
            self.callbacks = (c.c_void_p * 5)(*functions, None, None)
            more = (token, where, self.callbacks, 0, 0)
            return self._made("Instantiate", b"plain", int(stepping), *more)
        place = f"{self.folder.name}/resources/".encode()
        more = (token, place, c.c_bool(), c.c_bool())
        if stepping:
            modes = (c.c_bool(self.event_mode), c.c_bool(self.event_mode))
            more += (*modes, None, c.c_size_t(), None, LOG3, None)
        else:
            more += (None, LOG3)
        if interface == "ScheduledExecution":
            quiet = c.CFUNCTYPE(None)(lambda: None)
            self.callbacks = (c.CFUNCTYPE(None, c.c_void_p)(self._updated), quiet)
            more += (*self.callbacks, quiet)
        return self._made(f"Instantiate{interface}", b"plain", *more)

    def _updated(self, _: Any) -> None:
        self.updates += 1

    def _made(self, name: str, *arguments: Any) -> c.c_void_p:
        function = self.library[self.prefix + name]
        function.restype = c.c_void_p
        return c.c_void_p(function(*arguments))

    def call(self, name: str, *arguments: Any) -> None:
        status = self.library[self.prefix + name](self.handle, *arguments)
        assert status in (0, 1), f"{name} returned {status}"

    def size(self, v: Variable) -> int:
        return prod(self.sizes[s] if isinstance(s, str) else s for s in v.sizes)

    def _room(self, v: Variable) -> tuple[str, Any, list[Any]]:
        """Name of the access functions, room for the values, and what follows them."""
        name = v.type
        if name == "Enumeration":
            name = "Int64" if self.version == "3" else "Integer"
        kind = BOOLEANS[self.version] if name == "Boolean" else C_TYPES[name]
        n = self.size(v)
        last = [c.c_size_t(n)] if self.version == "3" and name != "Clock" else []
        return name, (kind * n)(), last

    def get(self, name: str) -> Any:
        v = self.variables[name]
        suffix, room, last = self._room(v)
        lengths = (c.c_size_t * len(room))()
        pointers = (c.c_void_p * len(room))() if suffix == "Binary" else room
        first = [lengths] if suffix == "Binary" else []
        one = (c.c_uint32 * 1)(v.reference)
        self.call(f"Get{suffix}", one, c.c_size_t(1), *first, pointers, *last)
        if suffix == "Binary":
            values = [
                c.string_at(p, n) if n else b"" for p, n in zip(pointers, lengths, strict=True)
            ]
        else:
            values = list(room)
        if suffix == "String":
            values = [text.decode() for text in values]
        if suffix == "Boolean":
            values = [bool(x) != v.negated for x in values]
        elif v.negated:
            values = [-x for x in values]
        return values if v.sizes else values[0]

    def set(self, name: str, value: Any) -> None:
        v = self.variables[name]
        suffix, room, last = self._room(v)
        values = value if v.sizes else [value]
        for i, x in enumerate(values):
            room[i] = x.encode() if isinstance(x, str) else x
        one, first = (c.c_uint32 * 1)(v.reference), []
        if suffix == "Binary":
            first = [(c.c_size_t * len(room))(*map(len, values))]
        if str(v.reference) in self.sizes:
            self.sizes[str(v.reference)] = value
            self.call("EnterConfigurationMode")
        self.call(f"Set{suffix}", one, c.c_size_t(1), *first, room, *last)
        if v.causality == "structuralParameter":
            self.call("ExitConfigurationMode")

    def __enter__(self) -> "PlainFmu":
        return self

    def __exit__(self, *_: object) -> None:
        name = "FreeInstance"
        if self.version == "1":
            name = "FreeSlaveInstance" if self.kind == "co-simulation" else "FreeModelInstance"
        function = self.library[self.prefix + name]
        function.restype = None
        function(self.handle)
        self.folder.cleanup()
