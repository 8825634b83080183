"""A home that cannot be written, none at all, a compiler that fails: a plant becomes an FMU, and
one note says where or as what."""

from pathlib import Path

import pytest

from fmus.packaging.cache import _writable, cache_directory, kept
from fmus.packaging.errors import PortableFallback
from fmus.packaging.plant.build import cached_fmu
from tests.fmus.packaging.plants import oscillator


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("FMU_HARNESS_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    (tmp_path / "file").write_text("no folder can be made below this")
    _writable.cache_clear()
    return tmp_path


def no_home() -> Path:
    raise RuntimeError("Could not determine home directory.")


def test_a_home_that_cannot_be_written(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(temporary / "file" / "home"))
    with pytest.warns(
        UserWarning, match=r"Not a directory\), so they are built in .*/tmp/"
    ) as told:
        path = cached_fmu(oscillator, 3)
        assert cached_fmu(oscillator, 3) == path
    assert len(told) == 1 and temporary / "tmp" in path.parents
    assert path.parents[1].stat().st_mode & 0o077 == 0


def test_no_home(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Path, "home", no_home)
    with pytest.warns(UserWarning, match="you have no home"):
        assert temporary / "tmp" in cache_directory().parents


def test_a_temporary_folder_of_somebody_else_is_not_used(
    temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Path, "home", no_home)
    with pytest.warns(UserWarning):
        mine = cache_directory()
    mine.chmod(0o777)
    _writable.cache_clear()
    with pytest.warns(UserWarning):
        assert cache_directory() != mine


def test_what_is_in_a_cache_that_cannot_be_written_is_found(
    temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shared = temporary / "shared"
    (shared / "key").mkdir(parents=True)
    (shared / "key" / "plant.fmu").touch()
    monkeypatch.setenv("FMU_HARNESS_CACHE", str(shared))
    monkeypatch.setattr("fmus.packaging.cache._writable", lambda folder: temporary / "other")
    assert kept("key/plant.fmu") == shared / "key" / "plant.fmu"
    assert kept("key/another.fmu") == temporary / "other" / "key" / "another.fmu"


def test_a_compiler_that_fails(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cc = temporary / "broken-cc"
    cc.write_text(
        '#!/bin/sh\n[ "$1" = --version ] && exec echo broken 1.0\necho no header >&2\nexit 1\n'
    )
    cc.chmod(0o755)
    monkeypatch.setenv("CC", str(cc))
    monkeypatch.setenv("FMU_HARNESS_CACHE", str(temporary / "cache"))
    with pytest.warns(PortableFallback, match=r"failed \(no header\): .* portable FMU"):
        path = cached_fmu(oscillator, 3)
    assert path == cached_fmu(oscillator, 2, portable=True)
