"""Archives are hostile until checked: nothing is written outside, nothing is left behind."""

import random
import stat
import tempfile
import zipfile
from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi import archive as archive_module
from harness.fmi.fmu import Fmu
from tests.harness.fmi.archives import member, oscillator_fmu, rewritten

XML = b"<fmiModelDescription/>"


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):  # type: ignore[no-untyped-def]
    """A folder of its own for temporary files, empty again when the test ends."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield folder
    assert list(folder.iterdir()) == []


def make(path: Path, *members: tuple[str | zipfile.ZipInfo, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", XML)
        for name, content in members:
            archive.writestr(name, content)
    return path


def refused(path: Path) -> str:
    with pytest.raises(FmuError) as caught:
        Fmu(path)
    text = str(caught.value)
    assert str(path) in text and "\n" not in text
    return text


@pytest.mark.parametrize(
    "name", ["../evil", "a/../../evil", "/etc/evil", "c:/evil", "a\\..\\..\\evil", ".."]
)
def test_members_that_leave_the_folder(tmp_path: Path, name: str) -> None:
    assert "leaves its folder" in refused(make(tmp_path / "a.fmu", (name, b"x")))
    assert not (tmp_path / "evil").exists()


def test_symbolic_links(tmp_path: Path) -> None:
    link = zipfile.ZipInfo("resources/link")
    link.create_system, link.external_attr = 3, (stat.S_IFLNK | 0o777) << 16
    assert "symbolic link" in refused(make(tmp_path / "a.fmu", (link, b"/etc/passwd")))


def test_bombs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive_module, "MAX_BYTES", 10_000)
    assert "unpacks to 20022 bytes" in refused(make(tmp_path / "a.fmu", ("zeros", bytes(20_000))))
    monkeypatch.setattr(archive_module, "MAX_MEMBERS", 3)
    many = make(tmp_path / "b.fmu", *((f"m{i}", b"") for i in range(5)))
    assert "has 6 members; at most 3" in refused(many)


def test_broken_archives(tmp_path: Path) -> None:
    words = random.Random(1).choices(b"abcdefgh   ", k=5000)
    good = make(tmp_path / "good.fmu", ("data", bytes(words))).read_bytes()
    middle = good.index(b"data") + 300
    for name, content in {
        "text": b"no archive at all",
        "empty": b"",
        "cut": good[: len(good) // 2],
        "garbled": good[:middle] + bytes(b ^ 0xFF for b in good[middle : middle + 60])
        + good[middle + 60 :],
        "misnamed": good.replace(b"data", b"d\xff\xfe\xfd"),
    }.items():  # fmt: skip
        path = tmp_path / f"{name}.fmu"
        path.write_bytes(content)
        refused(path)


def test_not_a_file_and_no_description(tmp_path: Path) -> None:
    assert "is not a file" in refused(tmp_path / "missing.fmu")
    assert "is not a file" in refused(tmp_path)
    empty = tmp_path / "a.fmu"
    with zipfile.ZipFile(empty, "w") as archive:
        archive.writestr("readme.txt", "hello")
    assert "no modelDescription.xml" in refused(empty)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_a_doctype_is_refused_in_any_encoding(tmp_path: Path, encoding: str) -> None:
    source = oscillator_fmu(2)
    xml = member(source, "modelDescription.xml").decode()
    head, _, body = xml.partition("?>")
    doctype = '<!DOCTYPE fmiModelDescription [<!ENTITY e SYSTEM "file:///etc/hostname">]>'
    text = f'<?xml version="1.0" encoding="{encoding}"?>{doctype}{body}'
    bad = rewritten(source, tmp_path / "a.fmu", modelDescription_dot_xml=text.encode(encoding))
    assert head and "DOCTYPE" in refused(bad)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ((b'fmiVersion="2.0"', b'fmiVersion="7.5"'), "is of FMI version '7.5'; versions 1.0"),
        ((b"</fmiModelDescription>", b""), "cannot be read"),
        ((b"<ModelVariables>", b"<ModelVariables><Odd/>"), "is not valid"),
    ],
)
def test_documents_that_are_not_valid(
    tmp_path: Path, change: tuple[bytes, bytes], words: str
) -> None:
    source = oscillator_fmu(2)
    xml = member(source, "modelDescription.xml")
    assert change[0] in xml
    bad = rewritten(source, tmp_path / "a.fmu", modelDescription_dot_xml=xml.replace(*change))
    with pytest.raises(FmuError, match=words):
        Fmu(bad)


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
