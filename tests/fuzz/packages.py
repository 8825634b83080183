"""What is fuzzed of SSP: a system description, a parameter set, a mapping, and a whole package.

Each is read as a run would read it, up to the systems of its variants, in a package whose other
files are sound. What is accepted is written and read again, and must be the same.
"""

from __future__ import annotations

import zipfile
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import TypeVar

from harness.ssp import DEFAULT, binding
from harness.ssp.document import SystemStructure
from harness.ssp.parameters import ParameterMapping, ParameterSet
from harness.ssp.to_experiment import open_experiment
from tests.fuzz.place import CORPUS, place, written

SYSTEM, VALUES, MAPPING = (
    CORPUS / "system_structure" / "sound.ssd",
    CORPUS / "parameter_set" / "sound.ssv",
    CORPUS / "parameter_mapping" / "sound.ssm",
)
E = TypeVar("E", bound=binding.Element)


@cache
def fmu() -> bytes:
    """An FMU that is described only, as a package holds it."""
    made = BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        archive.write(CORPUS / "description" / "fmi2.xml", "modelDescription.xml")
    return made.getvalue()


def read(path: Path) -> None:
    """All that is asked of a package before a run."""
    with open_experiment(path) as experiment:
        for variant in experiment.variants[:3]:
            experiment.bench(variant).system()


@cache
def _folder() -> Path:
    folder = place() / "package"
    folder.mkdir()
    (folder / "lag.fmu").write_bytes(fmu())
    for source, name in ((SYSTEM, DEFAULT), (VALUES, "lag.ssv"), (MAPPING, "lag.ssm")):
        (folder / name).write_bytes(source.read_bytes())
    return folder


def _in_package(name: str, content: bytes, sound: Path) -> None:
    """Read the package with another file of that name, and put the sound one back."""
    path = _folder() / name
    path.write_bytes(content)
    try:
        read(path.parent)
    finally:
        path.write_bytes(sound.read_bytes())


def _comes_back(kind: type[E], content: bytes) -> None:
    document = binding.read(kind, content, "fuzzed")
    assert binding.read(kind, binding.write(document), "written") == document


def system_structure(content: bytes) -> None:
    """A system description (SSD)."""
    _comes_back(SystemStructure, content)
    _in_package(DEFAULT, content, SYSTEM)


def parameter_set(content: bytes) -> None:
    """A parameter set (SSV) to which a description refers."""
    _comes_back(ParameterSet, content)
    _in_package("lag.ssv", content, VALUES)


def parameter_mapping(content: bytes) -> None:
    """A parameter mapping (SSM) to which a description refers."""
    _comes_back(ParameterMapping, content)
    _in_package("lag.ssm", content, MAPPING)


def package(content: bytes) -> None:
    """A whole package (.ssp)."""
    read(written("fuzzed.ssp", content))
