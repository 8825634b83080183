"""The archive: sources, description, documentation and binary of one native FMU in a zip file.

The same plant gives the same bytes: entries are sorted, dated 1980-01-01 and carry the same
permissions; the token is a hash of everything that was generated.
"""

from __future__ import annotations

import hashlib
import tempfile
import uuid
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from fmus.packaging.codegen import MAIN_SOURCE, source_files
from fmus.packaging.compiler import Target, compile_library
from fmus.packaging.documentation import documentation_page
from fmus.packaging.errors import PackagingError
from fmus.packaging.expressions import plant_expressions
from fmus.packaging.model_description import model_description, xml_bytes
from fmus.packaging.structure import model_structure
from fmus.plant import Plant

_UNKNOWN_TOKEN = "{00000000-0000-0000-0000-000000000000}"
FMI_VERSIONS = (2, 3)


@dataclass(frozen=True)
class NativeContent:
    """Everything in a native FMU but the binary: files by path in the archive, and the token."""

    name: str
    fmi_version: int
    token: str
    files: dict[str, bytes]


def native_content(plant: Plant, fmi_version: int) -> NativeContent:
    """Generate the files of a native FMU; raises PackagingError when the plant is not sound."""
    if fmi_version not in FMI_VERSIONS:
        raise PackagingError(f"FMI version {fmi_version!r} is not made; choose 2 or 3.")
    expressions = plant_expressions(plant)
    structure = model_structure(expressions)

    def generate(token: str) -> dict[str, bytes]:
        files = {
            f"sources/{name}": text
            for name, text in source_files(expressions, fmi_version, token).items()
        }
        files["modelDescription.xml"] = model_description(
            expressions.interface, structure, fmi_version, token
        )
        page = "index.html" if fmi_version == 3 else "_main.html"
        files[f"documentation/{page}"] = documentation_page(plant)
        if fmi_version == 3:
            files["sources/buildDescription.xml"] = _build_description(plant.name)
        return files

    token = content_token(generate(_UNKNOWN_TOKEN))
    return NativeContent(plant.name, fmi_version, token, generate(token))


def content_token(files: dict[str, bytes]) -> str:
    """A token in GUID form, the hash of the files."""
    return f"{{{uuid.UUID(bytes=bytes.fromhex(content_hash(files))[:16])}}}"


def content_hash(files: dict[str, bytes]) -> str:
    """SHA-256 over names, lengths and contents, in the order of names."""
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\0{len(files[name])}\0".encode())
        digest.update(files[name])
    return digest.hexdigest()


def write_native_fmu(content: NativeContent, targets: Sequence[Target], path: Path) -> None:
    """Compile the sources for all `targets` and write the archive to `path`."""
    sources = {
        name.removeprefix("sources/"): data
        for name, data in content.files.items()
        if name.startswith("sources/")
    }
    binaries = compiled_binaries(content.name, content.fmi_version, sources, targets)
    write_archive({**content.files, **binaries}, path)


def compiled_binaries(
    name: str,
    fmi_version: int,
    sources: Mapping[str, bytes],
    targets: Sequence[Target],
    object_for: Callable[[str], bytes] | None = None,
) -> dict[str, bytes]:
    """The shared libraries by path in the archive, one a target.

    `object_for` gives an object file for a platform tuple, to be linked with the sources.
    """
    found = {}
    for target in targets:
        platform = target.platform
        with tempfile.TemporaryDirectory(prefix="fmu-harness-") as folder:
            for source, data in sources.items():
                Path(folder, source).write_bytes(data)
            objects: tuple[str, ...] = ()
            if object_for is not None:
                objects = ("step.o",)
                Path(folder, "step.o").write_bytes(object_for(platform.tuple))
            library = Path(folder, f"{name}{platform.suffix}")
            compile_library(
                target.compiler, Path(folder), MAIN_SOURCE, library, fmi_version, objects
            )
            binary = f"binaries/{platform.folder(fmi_version)}/{library.name}"
            found[binary] = library.read_bytes()
    return found


def write_archive(files: dict[str, bytes], path: Path) -> None:
    """A zip file whose bytes depend on `files` only; the model description comes first."""
    with zipfile.ZipFile(path, "w") as archive:
        for name in sorted(files, key=lambda n: (n != "modelDescription.xml", n)):
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, files[name])


def _build_description(identifier: str) -> bytes:
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    sources = ET.SubElement(configuration, "SourceFileSet", language="C99")
    ET.SubElement(sources, "SourceFile", name=MAIN_SOURCE)
    ET.SubElement(configuration, "Library", name="m")
    return xml_bytes(root)
