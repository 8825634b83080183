"""Odd archives and documents: a DOCTYPE in any encoding, comments, and who removes files."""

import tempfile
from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi.fmu import Fmu
from tests.harness.fmi.archives import member, oscillator_fmu, rewritten


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):  # type: ignore[no-untyped-def]
    """A folder of its own for temporary files, empty again when the test ends."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield folder
    assert list(folder.iterdir()) == []


def refused(path: Path) -> str:
    with pytest.raises(FmuError) as caught:
        Fmu(path)
    text = str(caught.value)
    assert str(path) in text and "\n" not in text
    return text


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_a_doctype_is_refused_in_any_encoding(tmp_path: Path, encoding: str) -> None:
    source = oscillator_fmu(2)
    xml = member(source, "modelDescription.xml").decode()
    head, _, body = xml.partition("?>")
    doctype = '<!DOCTYPE fmiModelDescription [<!ENTITY e SYSTEM "file:///etc/hostname">]>'
    text = f'<?xml version="1.0" encoding="{encoding}"?>{doctype}{body}'
    bad = rewritten(source, tmp_path / "a.fmu", modelDescription_dot_xml=text.encode(encoding))
    assert head and "DOCTYPE" in refused(bad)


def test_comments_are_harmless(tmp_path: Path) -> None:
    source = oscillator_fmu(3)
    xml = member(source, "modelDescription.xml")
    commented = xml.replace(b"<ModelVariables>", b"<!-- by hand --><?tool x?><ModelVariables>")
    assert commented != xml
    with Fmu(rewritten(source, tmp_path / "a.fmu", modelDescription_dot_xml=commented)) as fmu:
        assert fmu.description.co_simulation is not None
        assert fmu.description.co_simulation.provides_directional_derivatives


def test_the_folder_lives_as_long_as_the_fmu(temporary: Path) -> None:
    with Fmu(oscillator_fmu(3)) as fmu:
        assert fmu.folder.parent == temporary and (fmu.folder / "modelDescription.xml").is_file()
    assert not fmu.folder.exists()
