"""The shared library of an FMU: found, loaded and asked for the addresses of its functions."""

from __future__ import annotations

import ctypes
import platform
import sys
from pathlib import Path

from harness.errors import FmuError
from harness.fmi.mark import calling, returned

_SUFFIX = {"linux": ".so", "win32": ".dll", "darwin": ".dylib"}
_SYSTEM = {"linux": "linux", "win32": "windows", "darwin": "darwin"}
_FMI2_FOLDER = {"linux": "linux64", "win32": "win64", "darwin": "darwin64"}
_MACHINES = {"amd64": "x86_64", "x86-64": "x86_64", "arm64": "aarch64"}


def platform_tuple() -> str:
    """The FMI 3 name of this platform, such as "x86_64-linux"."""
    machine = platform.machine().lower()
    return f"{_MACHINES.get(machine, machine)}-{_SYSTEM.get(sys.platform, sys.platform)}"


def library_path(folder: Path, model_identifier: str, fmi_major: int) -> Path:
    """The library for this platform; raises `FmuError` naming the platforms that are there."""
    names = [platform_tuple()]
    if fmi_major < 3 and (names[0].startswith("x86_64") or sys.platform == "darwin"):
        names.insert(0, _FMI2_FOLDER.get(sys.platform, names[0]))
    suffix = _SUFFIX.get(sys.platform, ".so")
    binaries = folder / "binaries"
    for name in names:
        path = binaries / name / (model_identifier + suffix)
        if path.is_file():
            return path
    there = sorted(p.parent.name for p in binaries.glob("*/*") if p.suffix in _SUFFIX.values())
    raise FmuError(
        f"FMU has no library {model_identifier}{suffix} for {' or '.join(names)}; it has "
        + (", ".join(dict.fromkeys(there)) if there else "no libraries at all")
    )


# pythonfmu 0.7 frees its state twice when a process ends, which damages the heap, unless this
# function of its library has been called before; unloading does not, since C++ keeps it loaded.
_PYTHONFMU_FINALIZE = "finalizePythonInterpreter"

_loaded: dict[Path, Library] = {}


def load(path: Path) -> Library:
    """The library at `path`, the same object for all its instances; raises `FmuError`."""
    library = _loaded.get(path)
    if library is None:
        library = _loaded[path] = Library(path)
    return library


def unload_below(folder: Path) -> None:
    """Unload the libraries that lie below `folder` and have no instances left.

    A library's own clean-up then runs while everything that it refers to is still there, and its
    file can be removed on every platform. One that reported Fatal is left alone.
    """
    for path in [path for path in _loaded if path.is_relative_to(folder)]:
        library = _loaded[path]
        if library.instances == 0 and not library.corrupted:
            del _loaded[path]
            calling(path.name, "unloading the library")
            library.close()
            returned()


class Library:
    """A loaded shared library; `address` gives function addresses.

    `corrupted` is set when an instance reports Fatal: nothing in it may be called any more.
    `instances` counts those that live.
    """

    def __init__(self, path: Path) -> None:
        """Load `path`; raises `FmuError` with the loader's reason."""
        self.path = path
        self.corrupted = False
        self.instances = 0
        try:
            self._library = ctypes.CDLL(str(path))
        except OSError as fault:
            raise FmuError(f"library {path.name} of the FMU cannot be loaded: {fault}") from fault

    def address(self, name: str) -> int:
        """Address of the function `name`; raises `FmuError` when the library lacks it."""
        address = self.find(name)
        if address is None:
            raise FmuError(f"library {self.path.name} has no function {name}")
        return address

    def close(self) -> None:
        """Unload; no address of it may be used any more."""
        finalize = self.find(_PYTHONFMU_FINALIZE)
        if finalize is not None:
            ctypes.PYFUNCTYPE(None)(finalize)()
        handle = self._library._handle
        if sys.platform == "win32":
            import _ctypes

            _ctypes.FreeLibrary(handle)
        else:
            close = ctypes.CDLL(None).dlclose
            close.argtypes = [ctypes.c_void_p]
            close(handle)

    def find(self, name: str) -> int | None:
        """Address of the function `name`, or None."""
        try:
            return ctypes.cast(getattr(self._library, name), ctypes.c_void_p).value
        except AttributeError:
            return None
