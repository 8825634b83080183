"""The C compiler of this machine: `cc` and its like, else the one in the PyPI package ziglang."""

from __future__ import annotations

import importlib.util
import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from fmus.packaging.errors import CompilerError, PackagingError

# Contraction to fused multiply-add is off: then machines with and without it agree bit by bit.
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=hidden")
_ARCHITECTURES = {"amd64": "x86_64", "x86_64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64"}
_SYSTEMS = {"linux": ("linux", ".so"), "win32": ("windows", ".dll"), "darwin": ("darwin", ".dylib")}
_FMI2_FOLDERS = {
    "x86_64-linux": "linux64",
    "x86_64-windows": "win64",
    "x86_64-darwin": "darwin64",
}
# Zig would tune for the CPU and the C library of this very machine; an FMU travels.
_ZIG_TARGETS = {
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-windows": "x86_64-windows-gnu",
    "x86_64-darwin": "x86_64-macos.11.0",
    "aarch64-darwin": "aarch64-macos.11.0",
}


@dataclass(frozen=True)
class Platform:
    """A platform as FMI names it: `tuple` as in FMI 3 (`x86_64-linux`), library `suffix`."""

    tuple: str
    suffix: str

    def folder(self, fmi_version: int) -> str:
        """Name of its folder under `binaries/`."""
        return _FMI2_FOLDERS.get(self.tuple, self.tuple) if fmi_version == 2 else self.tuple


PLATFORMS = {
    name: Platform(name, next(s for system, s in _SYSTEMS.values() if name.endswith(system)))
    for name in _ZIG_TARGETS
}


@dataclass(frozen=True)
class Compiler:
    """A command that understands the options of cc; `identity` is what it says of its version."""

    command: tuple[str, ...]
    identity: str


@dataclass(frozen=True)
class Target:
    """A platform to build for, and the compiler that does it."""

    platform: Platform
    compiler: Compiler

    @property
    def identity(self) -> str:
        """What decides the binary, besides its sources."""
        return f"{self.compiler.identity} {FLAGS} {self.platform.tuple}"


def running_platform() -> Platform:
    """The platform of this process; raises PackagingError when FMI has no name for it."""
    machine = platform.machine().lower()
    if sys.platform not in _SYSTEMS or machine not in _ARCHITECTURES:
        raise PackagingError(
            f"No native FMU can be built on {sys.platform} {machine}; known are "
            f"{sorted(_SYSTEMS)} on {sorted(set(_ARCHITECTURES))}. Ask for the portable FMU."
        )
    system, suffix = _SYSTEMS[sys.platform]
    return Platform(f"{_ARCHITECTURES[machine]}-{system}", suffix)


def find_compiler() -> Compiler | None:
    """The first that answers: environment variable CC, cc, gcc, clang, ziglang; else None."""
    return _find_compiler(os.environ.get("CC", ""), os.environ.get("PATH", ""))


@lru_cache(maxsize=8)
def _find_compiler(environment_cc: str, _path: str) -> Compiler | None:
    candidates = [tuple(shlex.split(environment_cc))] if environment_cc.strip() else []
    candidates += [("cc",), ("gcc",), ("clang",)]
    for command in candidates:
        if shutil.which(command[0]) and (identity := _identity(command)):
            return Compiler(command, identity)
    return cross_compiler(running_platform().tuple)


def cross_compiler(platform_tuple: str) -> Compiler | None:
    """The one in the PyPI package ziglang, compiling for `platform_tuple`; None without it."""
    return _cross_compiler(platform_tuple, importlib.util.find_spec("ziglang") is not None)


@lru_cache(maxsize=16)
def _cross_compiler(platform_tuple: str, installed: bool) -> Compiler | None:
    if not installed or platform_tuple not in _ZIG_TARGETS:
        return None
    zig = (sys.executable, "-m", "ziglang", "cc", "-target", _ZIG_TARGETS[platform_tuple])
    return Compiler(zig, identity) if (identity := _identity(zig)) else None


def find_targets(names: Sequence[str] = ()) -> tuple[Target, ...]:
    """What to build for: the running platform when no names are given, "all" for all that are
    known, else platforms as FMI 3 names them ("aarch64-linux") or FMI 2 does ("win64").

    Raises PackagingError for a name that is not known, and where there is no compiler for one.
    """
    if not names:
        wanted = [running_platform().tuple]
    elif "all" in names:
        wanted = sorted(PLATFORMS)
    else:
        wanted = [_platform_tuple(name) for name in dict.fromkeys(names)]
    return tuple(_target(name) for name in wanted)


def _platform_tuple(name: str) -> str:
    tuples = {folder: platform for platform, folder in _FMI2_FOLDERS.items()}
    found = tuples.get(name, name)
    if found not in PLATFORMS:
        raise PackagingError(
            f"The platform {name!r} is not known; choose from {', '.join(sorted(PLATFORMS))}, or "
            "'all'."
        )
    return found


def _target(name: str) -> Target:
    own = name == running_platform().tuple
    compiler = find_compiler() if own else cross_compiler(name)
    if compiler is None:
        raise PackagingError(
            f"There is no C compiler for {name}; `pip install fmu-harness[zig]` brings one that "
            "compiles for " + ", ".join(sorted(PLATFORMS)) + "."
        )
    return Target(PLATFORMS[name], compiler)


def _identity(command: tuple[str, ...]) -> str:
    """What `--version` prints, "" when the command does not run."""
    try:
        result = subprocess.run(
            [*command, "--version"], capture_output=True, text=True, timeout=120, check=True
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return f"{' '.join(command)}: {result.stdout.strip()}"


def compile_library(
    compiler: Compiler,
    sources: Path,
    main: str,
    library: Path,
    fmi: int,
    objects: tuple[str, ...] = (),
) -> None:
    """Compile `sources/main` and link `sources/object` of all `objects` into the shared library
    `library`, for the platform that `compiler` compiles for.

    Paths inside the compilation are relative, so the library does not depend on where it was
    built. Raises CompilerError with the compiler's words when it fails.
    """
    library = library.resolve()
    command = [
        *compiler.command,
        *FLAGS,
        f"-DFMI{fmi}_OVERRIDE_FUNCTION_PREFIX",
        main,
        *objects,
        "-o",
        str(library),
        "-lm",
    ]
    try:
        result = subprocess.run(
            command, cwd=sources, capture_output=True, text=True, timeout=600, check=False
        )
    except (OSError, subprocess.SubprocessError) as error:
        raise CompilerError(f"The C compiler {compiler.command} did not run: {error}") from error
    if result.returncode != 0 or not library.exists():
        raise CompilerError(
            f"The C compiler failed on {main} ({shlex.join(command)}):\n{result.stderr.strip()}"
        )
