"""An FMU instance called through ctypes alone: which status does which function return where?"""

from __future__ import annotations

import ctypes
import zipfile
from ctypes import byref, c_bool, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

MODEL_EXCHANGE, CO_SIMULATION = "ModelExchange", "CoSimulation"
OK, WARNING, DISCARD, ERROR, FATAL = range(5)
_LOGGER_2 = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
_LOGGER_3 = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)


class _Callbacks(ctypes.Structure):
    _fields_ = (
        ("logger", _LOGGER_2), ("allocate", c_void_p), ("free", c_void_p),
        ("step_finished", c_void_p), ("environment", c_void_p),
    )  # fmt: skip


class Raw:
    """The FMU at `path`, unpacked into `folder`; `messages` is what its logger received."""

    def __init__(self, path: Path, kind: str, folder: Path) -> None:
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        root = ElementTree.parse(folder / "modelDescription.xml").getroot()
        self.version, self.kind = int(root.attrib["fmiVersion"][0]), kind
        self.references = {
            v.attrib["name"]: int(v.attrib["valueReference"])
            for v in root.find("ModelVariables") or ()
        }
        name = root.find(kind).attrib["modelIdentifier"]  # type: ignore[union-attr]
        platform = "linux64" if self.version == 2 else "x86_64-linux"
        library = folder / "binaries" / platform / f"{name}.so"
        # portable libraries call Python, which PyDLL expects
        portable = (folder / "resources").exists()
        self._library = ctypes.PyDLL(str(library)) if portable else ctypes.CDLL(str(library))
        self.messages: list[tuple[int, str]] = []
        token = root.attrib["guid" if self.version == 2 else "instantiationToken"].encode()
        make = self._make_2 if self.version == 2 else self._make_3
        self.instance = make(token, folder / "resources")
        assert self.instance, self.messages

    def call(self, name: str, *arguments: Any) -> int:
        """The status of `fmi<version><name>(instance, *arguments)`."""
        function = getattr(self._library, f"fmi{self.version}{name}")
        function.restype = c_int
        return int(function(c_void_p(self.instance), *arguments))

    def free(self) -> None:
        self._library[f"fmi{self.version}FreeInstance"](c_void_p(self.instance))

    def set(self, name: str, value: float) -> int:
        reference, number = (c_uint * 1)(self.references[name]), (c_double * 1)(value)
        if self.version == 2:
            return self.call("SetReal", reference, c_size_t(1), number)
        return self.call("SetFloat64", reference, c_size_t(1), number, c_size_t(1))

    def get(self, name: str) -> float:
        number = (c_double * 1)()
        reference = (c_uint * 1)(self.references[name])
        more = (c_size_t(1),) if self.version == 3 else ()
        kind = "GetReal" if self.version == 2 else "GetFloat64"
        assert self.call(kind, reference, c_size_t(1), number, *more) == OK
        return float(number[0])

    def enter_initialization(self, start: float = 0.0) -> int:
        if self.version == 3:
            return self.call("EnterInitializationMode", c_bool(False), c_double(0),
                             c_double(start), c_bool(False), c_double(0))  # fmt: skip
        self.call("SetupExperiment", c_int(0), c_double(0), c_double(start), c_int(0), c_double(0))
        return self.call("EnterInitializationMode")

    def step(self, time: float, length: float) -> int:
        if self.version == 2:
            return self.call("DoStep", c_double(time), c_double(length), c_int(1))
        flags, last = [byref(c_bool()) for _ in range(3)], byref(c_double())
        return self.call("DoStep", c_double(time), c_double(length), c_bool(True), *flags, last)

    def bring_to(self, state: str) -> None:
        """From just instantiated to one of the states of the standard's state machine."""
        if state == "instantiated":
            return
        assert self.enter_initialization() == OK
        if state == "initialization":
            return
        assert self.call("ExitInitializationMode") == OK
        if state == "continuous":
            assert self.call("EnterContinuousTimeMode") == OK
        if state == "failed":
            assert self.step(0.0, 2.0) in (DISCARD, ERROR)
        if state == "terminated":
            assert self.call("Terminate") == OK

    def _make_2(self, token: bytes, resources: Path) -> int:
        self._callbacks = _Callbacks(_LOGGER_2(lambda _e, _n, s, _c, t: self._log(s, t)))
        make = self._library.fmi2Instantiate
        make.restype = c_void_p
        kind = c_int([MODEL_EXCHANGE, CO_SIMULATION].index(self.kind))
        where = resources.as_uri().encode()
        return int(make(b"raw", kind, token, where, byref(self._callbacks), 0, 1) or 0)

    def _make_3(self, token: bytes, resources: Path) -> int:
        self._logger = _LOGGER_3(lambda _e, s, _c, t: self._log(s, t))
        make = getattr(self._library, f"fmi3Instantiate{self.kind}")
        make.restype = c_void_p
        where = (str(resources) + "/").encode()
        head = (b"raw", token, where, c_bool(False), c_bool(True))
        if self.kind == MODEL_EXCHANGE:
            return int(make(*head, None, self._logger) or 0)
        none = (c_bool(False), c_bool(False), None, c_size_t(0), None)
        return int(make(*head, *none, self._logger, None) or 0)

    def _log(self, status: int, text: bytes) -> None:
        self.messages.append((status, text.decode()))
