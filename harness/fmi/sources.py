"""FMUs that hold sources and no library for this machine: built by the compiler that builds ours,
into a copy in the cache.

The headers of the standard are those that FMPy ships, for sources that bring none.
"""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from typing import Any

from lxml import etree

from harness import registry
from harness.errors import FmuError
from harness.fmi.binding.library import library_member, library_path
from harness.fmi.fmu import Fmu

Build = tuple[tuple[str, ...], tuple[str, ...]]
"""Files below `sources`, and options for the compiler."""


def compiled(path: str | Path, *, validate: bool = True) -> Path:
    """A copy of the FMU with libraries built from its sources, `path` itself where it lacks none;
    raises `FmuError` where it has no such sources or the compiler fails."""
    path = Path(path)
    with Fmu(path, validate=validate) as fmu:
        d = fmu.description
        kinds = (d.co_simulation, d.model_exchange, d.scheduled_execution)
        needed = dict.fromkeys(c.model_identifier for c in kinds if c is not None)
        missing = [name for name in needed if not _is_there(fmu.folder, name, d.fmi_major)]
        builds = {
            library_member(name, d.fmi_major): _build(fmu.folder, name, d.fmi_major, path)
            for name in missing
        }
        if not missing:
            return path
        try:
            made: Path = registry.packager("sources")(path, fmu.sha256, fmu.folder, builds)
        except Exception as fault:  # a packager of another package has errors of its own
            raise FmuError(f"FMU {path} cannot be built: {fault}") from fault
    return made


def _is_there(folder: Path, identifier: str, major: int) -> bool:
    try:
        library_path(folder, identifier, major)
    except FmuError:
        return False
    return True


def _build(folder: Path, identifier: str, major: int, path: Path) -> Build:
    """What the FMU says of its sources; where it says nothing, the file of the library's name."""
    sources = folder / "sources"
    described = sources / "buildDescription.xml" if major == 3 else folder / "modelDescription.xml"
    root: Any = etree.parse(described).getroot() if described.is_file() else etree.Element("none")
    named = [e for e in root if e.get("modelIdentifier", identifier) == identifier]
    files = [f.get("name", "") for e in named for f in e.iter("File", "SourceFile")]
    names = tuple(dict.fromkeys(files)) or (f"{identifier}.c",)
    includes = [i.get("name", "") for e in named for i in e.iter("IncludeDirectory")]
    definitions = [
        f"-D{d.get('name')}" + (f"={d.get('value')}" if d.get("value") else "")
        for e in named
        for d in e.iter("PreprocessorDefinition")
    ]
    for name in (*names, *includes):
        inside = (sources / name).resolve().is_relative_to(sources.resolve())
        if name.startswith("-") or not inside or not (sources / name).exists():
            raise FmuError(
                f"FMU {path} cannot be built: it has no {name!r} below sources, of which its "
                f"library {identifier} is made; ask its maker for a library for this machine"
            )
    for one in definitions:
        if not re.fullmatch(r"-D\w+(=[^\n]*)?", one):
            raise FmuError(f"FMU {path} cannot be built: {one!r} defines nothing")
    found = importlib.util.find_spec("fmpy")
    headers = Path(str(found and found.origin)).parent / "c-code"
    return names, (*definitions, "-I.", *(f"-I{name}" for name in includes), f"-I{headers}")
