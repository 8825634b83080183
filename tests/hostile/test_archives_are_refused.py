"""Every hostile archive is refused in one sentence and leaves no file behind."""

import os
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi.archive import unpack as archive_module
from harness.fmi.fmu import Fmu
from tests.hostile.archives import ARCHIVES, packed


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A folder of its own for temporary files, empty again when the test ends."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield
    assert list(folder.iterdir()) == []


def refused(path: Path, words: str) -> None:
    with pytest.raises(FmuError, match=words) as caught:
        Fmu(path)
    text = str(caught.value)
    assert str(path) in text and "\n" not in text and len(text) < 500
    assert re.search(r"; .*\b(pack|give|leave out|mend|TMPDIR)\b", text)


@pytest.mark.parametrize("case", ARCHIVES)
def test_archive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, case: str) -> None:
    monkeypatch.setattr(archive_module, "MAX_BYTES", 100_000)
    monkeypatch.setattr(archive_module, "MAX_MEMBERS", 50)
    monkeypatch.setattr(archive_module, "RATIO_FREE_BYTES", 50_000)
    make, words = ARCHIVES[case]
    path = tmp_path / "case.fmu"
    path.write_bytes(make())
    refused(path, words)
    assert not (tmp_path / "evil").exists()


def test_bytes_are_counted_while_they_are_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Were the declared sizes wrong in a way that zipfile follows, the count still ends it."""
    monkeypatch.setattr(archive_module.Archive, "_check_size", lambda self, members: None)
    monkeypatch.setattr(archive_module, "MAX_BYTES", 1000)
    path = tmp_path / "case.fmu"
    path.write_bytes(packed(("zeros", bytes(5000))))
    refused(path, "member 'zeros' is larger than")


def test_what_is_no_file(tmp_path: Path) -> None:
    refused(tmp_path / "missing.fmu", "is not a file; give the path")
    refused(tmp_path, "is not a file but a folder; pack what is in it")
    pipe = tmp_path / "pipe.fmu"
    os.mkfifo(pipe)
    refused(pipe, "is not a file")
    refused(tmp_path / ("a" * 300 + ".fmu"), "cannot be read: File name too long")


def test_no_place_to_unpack(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    path = tmp_path / "case.fmu"
    path.write_bytes(packed())
    refused(path, "no folder to unpack it into")


@pytest.mark.parametrize(("content", "words"), [
    (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "`git lfs pull`"),
    (b"<!DOCTYPE html><html></html>", "a web page: download the file itself"),
    (b"plain text", "an FMU is a zip archive: give the path"),
])  # fmt: skip
def test_what_is_no_zip_archive_is_told(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "case.fmu"
    path.write_bytes(content)
    with pytest.raises(FmuError, match=f"not a zip file; .*{words}"):
        Fmu(path)
