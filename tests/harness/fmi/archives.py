"""FMUs for the tests: made of our own packaging, or by hand as zip archives."""

import zipfile
from functools import cache
from pathlib import Path

from fmus.packaging.plant.build import cached_fmu
from tests.fmus.packaging.plants import oscillator


@cache
def oscillator_fmu(fmi_version: int) -> Path:
    """A damped oscillator, native, in the user's cache of built FMUs."""
    return cached_fmu(oscillator, fmi_version)


def rewritten(path: Path, target: Path, **changes: bytes | None) -> Path:
    """A copy of an FMU whose members (the key "/" as "__", "." as "_dot_") are replaced or gone."""
    named = {k.replace("__", "/").replace("_dot_", "."): v for k, v in changes.items()}
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(target, "w") as made:
        for member in source.namelist():
            if member in named:
                continue
            made.writestr(member, source.read(member))
        for member, content in named.items():
            if content is not None:
                made.writestr(member, content)
    return target


def member(path: Path, name: str) -> bytes:
    with zipfile.ZipFile(path) as archive:
        return archive.read(name)
