"""The native FMU of a plant: sources, description, documentation, and binaries made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from fmus.declaration import PlantModel
from fmus.packaging.archive import UNKNOWN_TOKEN, compiled_binaries, content_token, write_archive
from fmus.packaging.c_source import MAIN_SOURCE
from fmus.packaging.compiler import Target
from fmus.packaging.documentation import documents
from fmus.packaging.errors import PackagingError
from fmus.packaging.model_description import xml_bytes
from fmus.packaging.plant.codegen import source_files
from fmus.packaging.plant.expressions import plant_expressions
from fmus.packaging.plant.model_description import model_description
from fmus.packaging.plant.page import plant_page
from fmus.packaging.plant.structure import model_structure

FMI_VERSIONS = (2, 3)


@dataclass(frozen=True)
class NativeContent:
    """Everything in a native FMU but the binary: files by path in the archive, and the token."""

    name: str
    fmi_version: int
    token: str
    files: dict[str, bytes]


def native_content(plant: PlantModel, fmi_version: int) -> NativeContent:
    """Generate the files of a native FMU; raises PackagingError when the plant is not sound."""
    if fmi_version not in FMI_VERSIONS:
        raise PackagingError(f"FMI version {fmi_version!r} is not made; choose 2 or 3.")
    expressions = plant_expressions(plant)
    structure = model_structure(expressions)

    names = [[v.name for v in group] for group in (plant.inputs, plant.outputs)]
    papers = documents(plant_page(plant), fmi_version, *names)

    def generate(token: str) -> dict[str, bytes]:
        files = {
            f"sources/{name}": text
            for name, text in source_files(expressions, fmi_version, token).items()
        }
        files["modelDescription.xml"] = model_description(
            expressions.interface, structure, fmi_version, token
        )
        files |= papers
        if fmi_version == 3:
            files["sources/buildDescription.xml"] = _build_description(plant.name)
        return files

    token = content_token(generate(UNKNOWN_TOKEN))
    return NativeContent(plant.name, fmi_version, token, generate(token))


def write_native_fmu(content: NativeContent, targets: Sequence[Target], path: Path) -> None:
    """Compile the sources for all `targets` and write the archive to `path`."""
    sources = {
        name.removeprefix("sources/"): data
        for name, data in content.files.items()
        if name.startswith("sources/")
    }
    binaries = compiled_binaries(content.name, content.fmi_version, sources, targets)
    write_archive({**content.files, **binaries}, path)


def _build_description(identifier: str) -> bytes:
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    sources = ET.SubElement(configuration, "SourceFileSet", language="C99")
    ET.SubElement(sources, "SourceFile", name=MAIN_SOURCE)
    ET.SubElement(configuration, "Library", name="m")
    return xml_bytes(root)
