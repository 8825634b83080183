"""Machine code kept from one process to the next, wherever that is possible.

numba keeps it beside the source, or where `NUMBA_CACHE_DIR` says. Where neither can be written (an
installation for all users, a user without a home) it goes into the folder that `FMU_HARNESS_CACHE`
names, else into the user's cache folder. Where nothing can be written, code that is there is read,
other code is compiled anew in each process, and one note says so. Files that are damaged or cannot
be read count as not there.

This module refuses to fail: without a cache all works, and begins some seconds later.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any, Self, TypeVar

from numba import njit
from numba.core import config
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.ccallback import CFunc
from numba.core.sigutils import normalize_signature

F = TypeVar("F", bound=Callable[..., Any])
_APPLICATION = "fmu-harness"
_quiet = False
_announce: Callable[[str], object] = str


@contextmanager
def announcing(announce: Callable[[str], object]) -> Iterator[None]:
    """While open, `announce` is told what is about to be compiled, which can take some seconds."""
    global _announce
    before, _announce = _announce, announce
    try:
        yield
    finally:
        _announce = before


def compiled(function: F) -> F:
    """A function compiled by numba without the interpreter lock, with its machine code cached;
    floating-point faults are numbers, as in numpy."""
    made: Any = njit(nogil=True, error_model="numpy")(function)
    made._cache = _Cache(function)
    return made  # type: ignore[no-any-return]


def inlined(function: F) -> F:
    """A function that becomes part of the compiled functions that call it."""
    bare = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return njit(error_model="numpy", forceinline=True, **bare)(function)  # type: ignore[no-any-return]


@contextmanager
def settings(**chosen: Any) -> Iterator[None]:
    """While open, numba compiles with these of its settings (`numba.core.config`)."""
    before = {name: getattr(config, name) for name in chosen}
    for name, value in chosen.items():
        setattr(config, name, value)
    try:
        yield
    finally:
        for name, value in before.items():
            setattr(config, name, value)


def cached_callback(function: Callable[..., Any], signature: Any, **options: Any) -> Any:
    """The same for a C function of `signature`, compiled now or fetched; `function` may be
    compiled itself."""
    function = getattr(function, "py_func", function)
    made: Any = CFunc(function, normalize_signature(signature), locals={}, options=options)
    made._cache = _LockedCache(function)
    try:
        made.compile()
    finally:
        made._cache.unlock()
    return made


def say_nothing() -> None:
    """This process cannot write and need not be told so."""
    global _quiet
    _quiet = True


def _folders() -> list[Path]:
    """Where code may be kept that cannot stay beside its source."""
    chosen = os.environ.get("FMU_HARNESS_CACHE")
    found = [Path(chosen)] if chosen else []
    try:
        home = Path.home()
    except RuntimeError:  # the user has none
        return found
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or home / "AppData/Local")
    elif sys.platform == "darwin":
        base = home / "Library/Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    return [*found, base / _APPLICATION]


_HOUSE = Path(__file__).parents[1]
_COMPILED = ("compiler", "participants", "participants/model_exchange", "master/program")


@cache
def stamp() -> str:
    """Changes with every module from which compiled functions take something."""
    found = hashlib.sha256()
    for room in _COMPILED:
        for path in sorted((_HOUSE / room).glob("*.py")):
            about = path.stat()
            found.update(f"{path.name} {about.st_size} {about.st_mtime_ns}\n".encode())
    return found.hexdigest()


class _OwnPlace:
    """What numba calls a locator, of a function in a source file; asked after numba's own."""

    def __init__(self, function: FunctionType, source: str, folder: Path) -> None:
        self._source, self._folder = Path(source), folder
        self._line = function.__code__.co_firstlineno

    @classmethod
    def from_function(cls, function: FunctionType, source: str) -> Self | None:
        """The first folder that can be written, else that beside the source, to read from it."""
        if not Path(source).is_file():
            return None
        beside = Path(source).resolve().parent
        name = f"{beside.name}_{hashlib.sha256(os.fsencode(beside)).hexdigest()[:16]}"
        for folder in _folders():
            made = cls(function, source, folder / "machine_code" / name)
            try:
                made.ensure_cache_path()
            except OSError:
                continue
            return made
        return cls(function, source, beside / "__pycache__")

    def ensure_cache_path(self) -> None:
        """Raises `OSError` where the folder cannot be made or written."""
        self._folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=self._folder).close()

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._folder)

    def get_source_stamp(self) -> bytes:
        """Changes with the source, as numba's own does."""
        return hashlib.sha256(self._source.read_bytes()).digest()

    def get_disambiguator(self) -> str:
        """Tells functions of one name apart."""
        return str(self._line)


class _Files(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (*CompileResultCacheImpl._locator_classes, _OwnPlace)


class _Cache(FunctionCache):  # type: ignore[misc]
    """numba's cache, but for what it does where files cannot be read or written."""

    _impl_class = _Files

    def __init__(self, function: Any) -> None:
        """Code of ours also depends on the modules whose functions and constants are frozen into
        it, which numba does not look at."""
        super().__init__(function)
        self._function = function
        if Path(function.__code__.co_filename).is_relative_to(_HOUSE):
            self._cache_file._source_stamp = self._cache_file._source_stamp, stamp()

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What is kept, or None; pickled code that is damaged can raise anything, and goes."""
        found = self._load(sig, target_context)
        if found is None:
            _announce(getattr(self._function, "called", self._function.__name__))
        return found

    def _load(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:
            with suppress(OSError):
                self.flush()
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep it where that is possible."""
        try:
            super().save_overload(sig, data)
        except OSError as fault:
            self._tell(fault)

    def _tell(self, fault: Exception) -> None:
        if not _quiet:
            say_nothing()
            warnings.warn(
                f"machine code cannot be kept in {self.cache_path} ({fault}), so every process "
                "compiles it anew for some seconds; set FMU_HARNESS_CACHE to a folder that can be "
                "written",
                stacklevel=2,
            )


class _LockedCache(_Cache):
    """The same for code that takes long to compile: where two processes need it, one compiles, and
    the other waits for it."""

    _lock: int | None = None

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """As above; where there is nothing, this process has the lock from now on."""
        found = super().load_overload(sig, target_context)
        if found is None and self._locked():
            found = self._load(sig, target_context)
        return found

    def _locked(self) -> bool:
        with suppress(OSError, ImportError):  # read-only folders, other systems
            import fcntl

            path = Path(self.cache_path) / f"{self._function.__qualname__}.lock"
            self._lock = os.open(path, os.O_CREAT | os.O_RDWR, 0o666)
            fcntl.flock(self._lock, fcntl.LOCK_EX)
            return True
        return False

    def unlock(self) -> None:
        """It is compiled, or cannot be."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None
