"""FMPy's validator has nothing to say about any FMU of a plant."""

from pathlib import Path

from fmpy.validation import validate_fmu


def test_no_problems(any_fmu: Path) -> None:
    assert validate_fmu(str(any_fmu)) == []
