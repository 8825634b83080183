"""System structure packages: `.ssp` archives, their unpacked folders, and single `.ssd` files.

An archive is unpacked under the rules for FMU archives. What a description names by a URI is
looked for relative to it: inside the package where that is an archive, and anywhere relative to
a folder of the user's own. Absolute URIs and schemes are refused: nothing is downloaded. The FMU
that a proxy is to run (`proxyfmu://localhost?file=a.fmu`) is that file.
"""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import parse_qs, unquote, urlsplit
from warnings import warn

from harness.errors import ExperimentError, FmuError, HarnessError, nearest
from harness.export.certificate import zip_entry
from harness.fmi.archive.unpack import Archive
from harness.ssp import DEFAULT, binding
from harness.ssp.binding import E
from harness.ssp.document import SystemStructure

_PROXIES = ("proxyfmu", "fmu-proxy")
"""Schemes by which libcosim and its kin run the FMU `?file=…` in another process."""


@dataclass(frozen=True)
class Package:
    """A package on disk: `structures` are its root descriptions by file name, the default first.

    `path` is what the user named; `closed` packages may name nothing outside of `folder`.
    """

    path: Path
    folder: Path
    structures: Mapping[str, SystemStructure]
    closed: bool

    def where(self, file: str) -> str:
        """How faults name a document of this package."""
        return f"{self.path}/{file}" if self.path.suffix != ".ssd" else str(self.path)

    def resolve(self, uri: str, base: Path | None = None) -> Path:
        """The file that a relative URI names, seen from `base` (the root of the package)."""
        parts = urlsplit(uri)
        if parts.scheme in _PROXIES and (file := parse_qs(parts.query).get("file")):
            warn(
                f"{self.path}: {file[0]} runs here, not at {parts.netloc} by a proxy", stacklevel=2
            )
            parts = urlsplit(file[0])
        relative = unquote(parts.path)
        if parts.scheme or parts.netloc or relative.startswith("/") or "\\" in relative:
            raise ExperimentError(
                f"source {uri!r} is no relative URI, only files of the package are read; put the "
                "file into it, and name it as in resources/plant.fmu"
            )
        if not relative or "\0" in relative:
            raise ExperimentError(
                f"source {uri!r} names no file; give one, such as resources/plant.fmu"
            )
        root = self.folder.resolve()
        found = ((base or self.folder) / relative).resolve()
        if self.closed and not found.is_relative_to(root):
            raise ExperimentError(f"source {uri!r} leaves the package; put the file into it")
        if not found.exists():
            legal = [p.relative_to(root).as_posix() for p in root.rglob("*") if p.is_file()]
            raise ExperimentError(f"there is no file {uri!r}; {nearest(relative, legal)}")
        return found


@contextmanager
def open_package(path: str | Path) -> Iterator[Package]:
    """A package while its files are there; raises `ExperimentError`."""
    path = Path(path)
    with ExitStack() as stack:
        if path.suffix == ".ssd":
            content = {path.name: read_document(SystemStructure, path, str(path))}
            yield Package(path, path.parent, content, closed=False)
            return
        folder, closed = path, False
        if not path.is_dir():
            try:
                folder, closed = stack.enter_context(Archive(path, DEFAULT)).folder, True
            except FmuError as fault:
                raise ExperimentError(str(fault).replace("FMU", "SSP", 1)) from fault
        elif not (path / DEFAULT).is_file():
            raise ExperimentError(
                f"folder {path} has no {DEFAULT}; it is no unpacked SSP; give one"
            )
        files = {DEFAULT: read_document(SystemStructure, folder / DEFAULT, f"{path}/{DEFAULT}")}
        for name in sorted(p.name for p in folder.glob("*.ssd") if p.name != DEFAULT):
            with left_out_where_faulty(f"{path}/{name}"):
                files[name] = read_document(SystemStructure, folder / name, f"{path}/{name}")
        yield Package(path, folder, files, closed)


@contextmanager
def left_out_where_faulty(where: str) -> Iterator[None]:
    """A fault of a description other than the default one is a warning: the others may be run."""
    try:
        yield
    except HarnessError as fault:
        warn(f"the variant {where} is left out: {fault}", stacklevel=3)


def save_package(
    target: Path, structures: Mapping[str, SystemStructure], resources: Mapping[str, Path]
) -> None:
    """Write an archive of root descriptions and files by member name, byte for byte the same for
    the same content. Raises `ExperimentError` when it cannot be written."""
    made = target.with_name(target.name + ".part")
    try:
        with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, structure in structures.items():
                archive.writestr(zip_entry(name), binding.write(structure))
            for name, source in resources.items():
                with source.open("rb") as file, archive.open(zip_entry(name), "w") as member:
                    shutil.copyfileobj(file, member)
        made.replace(target)
    except OSError as fault:
        raise ExperimentError(f"{target} cannot be written: {fault}; choose another") from fault
    finally:
        made.unlink(missing_ok=True)


def files_of(package: Package) -> dict[str, Path]:
    """All files of a package but its root descriptions, by member name."""
    found = {p.relative_to(package.folder).as_posix(): p for p in package.folder.rglob("*")}
    return {
        name: path
        for name, path in sorted(found.items())
        if path.is_file() and name not in package.structures
    }


def read_document(kind: type[E], path: Path, where: str) -> E:
    """The document in a file; raises `ExperimentError`."""
    return binding.read(kind, read_bytes(path, where), where)


def read_bytes(path: Path, where: str) -> bytes:
    """The content of a file; raises `ExperimentError`."""
    try:
        return path.read_bytes()
    except OSError as fault:
        raise ExperimentError(f"{where} cannot be read: {fault}; give a readable file") from fault
