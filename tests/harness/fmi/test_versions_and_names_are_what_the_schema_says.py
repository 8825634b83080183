"""Versions that the schema's pattern allows are read, others are refused; blanks in names are what
XML makes of them."""

from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi.description.reader import read_model_description
from tests.hostile.build import description


def read(folder: Path, fmi: int, old: str, new: str):
    (folder / "modelDescription.xml").write_text(description(fmi).replace(old, new))
    return read_model_description(folder, Path("case.fmu"))


@pytest.mark.parametrize("version", ["3.0", "3.0.1", "3.0-beta.2", "3.0.0-rc 1", "3.1", "3.10.2"])
def test_versions_that_are_read(tmp_path: Path, version: str) -> None:
    described, faults = read(tmp_path, 3, '"3.0"', f'"{version}"')
    assert described.fmi_version == version and described.fmi_major == 3 and faults == ()


@pytest.mark.parametrize(
    ("fmi", "version"), [(3, "3.00"), (3, "3."), (3, "4.0"), (2, "2.0.3"), (2, "2.1"), (2, "2")]
)
def test_versions_that_are_none(tmp_path: Path, fmi: int, version: str) -> None:
    with pytest.raises(FmuError, match="is of FMI version"):
        read(tmp_path, fmi, f'"{fmi}.0"', f'"{version}"')


@pytest.mark.parametrize("blank", ["\t", "\n", "&#9;", "&#10;", "&#13;"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_blank_is_a_space(tmp_path: Path, fmi: int, blank: str) -> None:
    described, faults = read(tmp_path, fmi, 'name="u"', f'name="a{blank}b"')
    assert "a b" in described.variables and faults == ()
