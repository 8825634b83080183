"""Libraries from the sources of other people's FMUs."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from fmus.packaging.cache import place, write_atomically
from fmus.packaging.compiler import find_compiler
from fmus.packaging.errors import PackagingError

_OPTIONS = ("-O2", "-fPIC", "-shared", "-w", "-ffp-contract=off")
_PREFIXES = (
    "-DFMI2_OVERRIDE_FUNCTION_PREFIX=", "-DFMI3_OVERRIDE_FUNCTION_PREFIX=", "-DNO_FUNCTION_PREFIX"
)  # fmt: skip
"""A library's functions have no prefix, however the sources prefix them for static linking; the
last is what the sources of 20-sim ask for it."""

Builds = Mapping[str, tuple[Sequence[str], Sequence[str]]]
"""Files below `sources` and options for the compiler, by the library's place in the FMU."""


def with_libraries(fmu: Path, sha256: str, unpacked: Path, builds: Builds) -> Path:
    """A copy of the FMU with that hash that also holds the libraries, from the cache where it is
    there. Raises PackagingError with what the compiler says."""
    found = find_compiler()
    if found is None:
        raise PackagingError("there is no C compiler; `pip install fmu-harness[zig]` brings one")
    compiler = found

    def write(part: Path) -> None:
        shutil.copyfile(fmu, part)
        with (
            tempfile.TemporaryDirectory() as made,
            zipfile.ZipFile(part, "a", zipfile.ZIP_DEFLATED) as archive,
        ):
            for member, (files, options) in builds.items():
                library = Path(made, Path(member).name)
                extra = ("-lm",) if all(f.endswith(".c") for f in files) else ("-lm", "-lstdc++")
                _run([*compiler.command, *_OPTIONS, *_PREFIXES, *options, *files,
                      "-o", str(library), *extra], unpacked / "sources")  # fmt: skip
                archive.write(library, member)

    path = place(fmu.stem, sha256, f"{compiler.identity} {_OPTIONS} {_PREFIXES}")
    if not path.is_file():
        write_atomically(path, write)
    return path


def _run(command: Sequence[str], folder: Path) -> None:
    try:
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=600, check=False
        )
    except (OSError, subprocess.SubprocessError) as fault:
        raise PackagingError(f"the C compiler did not run: {fault}") from fault
    if done.returncode != 0:
        said = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr)
        raise PackagingError(f"the C compiler says {said.strip()!r}")
