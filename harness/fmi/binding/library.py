"""The shared library of an FMU: found, loaded and asked for the addresses of its functions."""

from __future__ import annotations

import ctypes
import platform
import re
import sys
from collections.abc import Iterable
from pathlib import Path

from harness.errors import FmuError
from harness.fmi.binding.binary import built_for, cut_short
from harness.fmi.binding.dependencies import load_with_neighbours
from harness.fmi.binding.interface import (
    CO_SIMULATION,
    MODEL_EXCHANGE,
    SCHEDULED_EXECUTION,
    InterfaceType,
)
from harness.fmi.binding.mark import calling, returned

_SUFFIX = {"linux": ".so", "win32": ".dll", "darwin": ".dylib"}
SUFFIXES = frozenset(_SUFFIX.values())
"""Of shared libraries, on all platforms."""


_SYSTEM = {"linux": "linux", "win32": "windows", "darwin": "darwin"}
_FMI2_FOLDER = {"linux": "linux64", "win32": "win64", "darwin": "darwin64"}
_MACHINES = {"amd64": "x86_64", "x86-64": "x86_64", "arm64": "aarch64"}

_STEPPING = {
    CO_SIMULATION: ("DoStep",), MODEL_EXCHANGE: ("SetTime", "SetContinuousStates"),
    SCHEDULED_EXECUTION: ("ActivateModelPartition",),
}  # fmt: skip
_REASONS = {
    r"^(\S+): cannot open shared object file": (
        "it needs the library {}, which is not installed here"
    ),
    r"undefined symbol: ([^\s,]+)": "it needs the symbol {}, which nothing here provides",
    r"version [`'](\S+)' not found": (
        "it needs {} of the C library or another, which is older here"
    ),
}


def platform_tuple() -> str:
    """The FMI 3 name of this platform, such as "x86_64-linux"."""
    machine = platform.machine().lower()
    return f"{_MACHINES.get(machine, machine)}-{_SYSTEM.get(sys.platform, sys.platform)}"


def library_path(folder: Path, model_identifier: str, fmi_major: int) -> Path:
    """The library for this platform; raises `FmuError` naming the platforms that are there."""
    names = _folders(fmi_major)
    suffix = _SUFFIX.get(sys.platform, ".so")
    binaries = folder / "binaries"
    for name in names:
        path = binaries / name / (model_identifier + suffix)
        if path.is_file():
            return path
    there = sorted(p for p in binaries.glob("*/*") if p.suffix in SUFFIXES)
    here = [p.name for p in there if p.parent.name in names]
    if here:
        found, way = f"{', '.join(here)} instead", "mend the modelIdentifier or the file's name"
    else:
        found = ", ".join(dict.fromkeys(p.parent.name for p in there)) or "no libraries at all"
        way = f"have it exported for {platform_tuple()}"
        if (folder / "sources").is_dir():
            found, way = f"{found} (and sources)", "--compile builds one"
    raise FmuError(
        f"FMU has no library {model_identifier}{suffix} for {' or '.join(names)}; "
        f"it has {found}: {way}"
    )


def _folders(fmi_major: int) -> list[str]:
    """The folders of `binaries` that this platform reads, the usual one first."""
    names = [platform_tuple()]
    if fmi_major < 3 and (names[0].startswith("x86_64") or sys.platform == "darwin"):
        names.insert(0, _FMI2_FOLDER.get(sys.platform, names[0]))
    return names


def library_member(model_identifier: str, fmi_major: int) -> str:
    """Where in an FMU a library for this platform lies."""
    suffix = _SUFFIX.get(sys.platform, ".so")
    return f"binaries/{_folders(fmi_major)[0]}/{model_identifier}{suffix}"


def instantiating(kind: InterfaceType) -> str:
    """The function of FMI 3 that makes an instance of this kind, without its prefix."""
    return "Instantiate" + kind.title().replace("-", "")


def mandatory_functions(fmi_major: int, kind: InterfaceType) -> tuple[str, ...]:
    """What every library of FMI 2 or 3 must have for any run; setters and getters are looked for
    when a variable of their type is used. FMI 1 prefixes its names, so none are known here."""
    if fmi_major == 1:
        return ()
    create = ("Instantiate", "SetupExperiment") if fmi_major == 2 else (instantiating(kind),)
    initialise = ("EnterInitializationMode", "ExitInitializationMode")
    names = (*create, *initialise, *_STEPPING[kind], "Terminate", "FreeInstance")
    return tuple(f"fmi{fmi_major}{name}" for name in names)


def _unfit(path: Path) -> str:
    """Why a library cannot be loaded here, seen from its file, or ""."""
    try:
        platform_of = built_for(path)
        if platform_of is None:
            return "it is no library of any known kind"
        if platform_tuple() not in platform_of.split(" and "):
            return f"it is built for {platform_of}, and this machine is {platform_tuple()}"
        return cut_short(path)
    except OSError as fault:
        return fault.strerror or str(fault)


def _loader_reason(text: str, path: Path) -> str:
    """The dynamic loader's message as a phrase that says what is missing."""
    text = " ".join(text.replace(f"{path}: ", "").split())
    for pattern, phrase in _REASONS.items():
        if found := re.search(pattern, text):
            return phrase.format(found[1])
    return text


# pythonfmu 0.7 frees its state twice when a process ends, which damages the heap, unless this
# function of its library has been called before; unloading does not, since C++ keeps it loaded.
_PYTHONFMU_FINALIZE = "finalizePythonInterpreter"

_loaded: dict[Path, Library] = {}


def load(path: Path) -> Library:
    """The library at `path`, the same object for all its instances; raises `FmuError`."""
    if path not in _loaded:
        _loaded[path] = Library(path)
    return _loaded[path]


def unload_below(folder: Path) -> None:
    """Unload the libraries that lie below `folder` and have no instances left.

    A library's own clean-up then runs while everything that it refers to is still there, and its
    file can be removed on every platform. One that reported Fatal is left alone.
    """
    for path in [path for path in _loaded if path.is_relative_to(folder)]:
        library = _loaded[path]
        if library.instances == 0 and not library.corrupted:
            del _loaded[path]
            calling(library.component, "unloading the library")
            library.close()
            returned()


class Library:
    """A loaded shared library; `address` gives function addresses.

    `corrupted` is set when an instance reports Fatal: nothing in it may be called any more.
    `instances` counts those that live, `component` is the name of the last one.
    """

    def __init__(self, path: Path) -> None:
        """Load `path`; raises `FmuError` with the loader's reason."""
        self.path = path
        self.corrupted = False
        self.instances = 0
        self.component = path.name
        fault = f"library {path.name} of the FMU cannot be loaded"
        if unfit := _unfit(path):
            raise FmuError(f"{fault}: {unfit}; have it exported anew for {platform_tuple()}")
        try:  # it lies at FMU/binaries/PLATFORM/NAME
            self._library, self._first = load_with_neighbours(path, path.parents[2])
        except OSError as said:
            raise FmuError(
                f"{fault}: {_loader_reason(str(said), path)}; install what it needs, or have it "
                "exported with that inside"
            ) from said

    def address(self, name: str) -> int:
        """Address of the function `name`; raises `FmuError` when the library lacks it."""
        address = self.find(name)
        if address is None:
            raise FmuError(
                f"library {self.path.name} of the FMU has no function {name}, which is to be "
                "called; have it exported with that"
            )
        return address

    def require(self, names: Iterable[str]) -> None:
        """Raise `FmuError` with all of the functions `names` that the library lacks."""
        missing = [name for name in names if self.find(name) is None]
        if missing:
            what = "function" if len(missing) == 1 else "functions"
            raise FmuError(
                f"library {self.path.name} of the FMU lacks the {what} {', '.join(missing)}, "
                "which the standard demands; have it exported with all of them"
            )

    def close(self) -> None:
        """Unload; no address of it may be used any more."""
        finalize = self.find(_PYTHONFMU_FINALIZE)
        if finalize is not None:
            ctypes.PYFUNCTYPE(None)(finalize)()
        for library in (self._library, *reversed(self._first)):
            _unload(library._handle)

    def find(self, name: str) -> int | None:
        """Address of the function `name`, or None."""
        try:
            return ctypes.cast(getattr(self._library, name), ctypes.c_void_p).value
        except AttributeError:
            return None


def _unload(handle: int) -> None:
    if sys.platform == "win32":
        import _ctypes

        _ctypes.FreeLibrary(handle)
    else:
        close = ctypes.CDLL(None).dlclose
        close.argtypes = [ctypes.c_void_p]
        close(handle)
