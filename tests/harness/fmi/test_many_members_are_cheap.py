"""An archive of four times the members takes about four times the work to unpack, and the files are
all there: in folders of their own, in one folder, and where each is there twice."""

import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.fmi.archive.unpack import Archive
from tests.harness.fmi.test_work_grows_no_faster_than_the_variables import lines


def names_of(count: int, layout: str) -> list[str]:
    if layout == "twice":
        return 2 * names_of(count // 2, "flat")
    folder = {"flat": "resources", "nested": "resources/{i}"}[layout]
    return [f"{folder.format(i=i)}/{i}.txt" for i in range(count)]


def archive_of(path: Path, count: int, layout: str) -> Path:
    with zipfile.ZipFile(path, "w") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of names that are there twice
        archive.writestr("modelDescription.xml", "<fmiModelDescription/>")
        for name in names_of(count, layout):
            archive.writestr(name, Path(name).stem)
    return path


def unpacker(names: set[str]) -> Callable[[Path], None]:
    def unpack(path: Path) -> None:
        with Archive(path) as archive:
            assert sum(1 for one in archive.folder.rglob("*.txt")) == len(names)

    return unpack


@pytest.mark.parametrize("layout", ["flat", "nested", "twice"])
def test_work_is_that_of_the_members(tmp_path: Path, layout: str) -> None:
    work = []
    for count in (100, 400):
        path = archive_of(tmp_path / f"{count}.fmu", count, layout)
        work.append(lines(unpacker(set(names_of(count, layout))), path))
    assert work[1] < 4.5 * work[0]


@pytest.mark.slow
def test_thirty_thousand_are_unpacked(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "many.fmu", 30_000, "flat")
    with Archive(path) as archive:
        assert len(list((archive.folder / "resources").iterdir())) == 30_000
        assert (archive.folder / "resources/29999.txt").read_text() == "29999"
