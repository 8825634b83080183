"""Page, licence, icon, terminals and what must be installed, in FMUs of each kind."""

import struct
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fmpy import read_model_description

from fmus.packaging.plant.build import cached_fmu
from tests.fmus.packaging.plants import oscillator, static_gain, van_der_pol

ROOT = Path(__file__).parents[3]
KINDS = [(2, False), (3, False), (2, True), (3, True)]


@pytest.fixture(params=KINDS, ids=["FMI 2", "FMI 3", "portable FMI 2", "portable FMI 3"])
def kind(request: pytest.FixtureRequest) -> tuple[int, bool]:
    version, portable = request.param
    return version, portable


@pytest.fixture
def files(kind: tuple[int, bool]) -> dict[str, bytes]:
    with zipfile.ZipFile(cached_fmu(oscillator, kind[0], portable=kind[1])) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_page_and_licence(files: dict[str, bytes], kind: tuple[int, bool]) -> None:
    page = files["documentation/index.html" if kind[0] == 3 else "documentation/_main.html"]
    assert b"&lt;with feedthrough &amp; markup&gt;" in page
    assert b"stiffness" in page
    licence = files["documentation/licenses/license.txt"]
    assert licence.decode().split() == (ROOT / "LICENSE").read_text().split()


def test_icon_is_a_picture(files: dict[str, bytes], kind: tuple[int, bool]) -> None:
    png = files["terminalsAndIcons/icon.png" if kind[0] == 3 else "model.png"]
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    assert struct.unpack(">II", png[16:24]) == (64, 64)


def test_what_must_be_installed_is_said_where_python_is_needed(
    files: dict[str, bytes], kind: tuple[int, bool]
) -> None:
    text = files.get("documentation/externalDependencies.txt")
    assert (text is not None) == kind[1]
    assert text is None or all(word in text for word in (b"libpython", b"LD_PRELOAD", b"Python 3"))


@pytest.mark.parametrize("plant", [oscillator, van_der_pol, static_gain], ids=lambda p: p.name)
def test_terminals_hold_all_inputs_and_outputs(plant: object) -> None:
    path = cached_fmu(plant, 3)  # type: ignore[arg-type]
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    found = {
        terminal.attrib["name"]: [m.attrib["variableName"] for m in terminal]
        for terminal in root.iter("Terminal")
    }
    variables = read_model_description(str(path)).modelVariables
    for causality in ("input", "output"):
        expected = [v.name for v in variables if v.causality == causality]
        assert sorted(found.get(f"{causality}s", [])) == sorted(expected)
