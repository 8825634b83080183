"""The same plant gives the same bytes; another plant, or another default, another token."""

import hashlib
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

from fmpy import read_model_description

from fmus.packaging.compiler import find_targets
from fmus.packaging.plant.build import cached_fmu
from fmus.packaging.plant.native import native_content, write_native_fmu
from tests.fmus.packaging.plants import hydraulic, oscillator

OTHER_PROCESS = """
import sys
from pathlib import Path
from fmus.packaging.plant.native import native_content, write_native_fmu
from fmus.packaging.compiler import find_targets
from fmus.packaging.plant.portable import portable_content, write_portable_fmu
from tests.fmus.packaging.plants import hydraulic
write_native_fmu(native_content(hydraulic, int(sys.argv[1])), find_targets(), Path("native.fmu"))
write_portable_fmu(portable_content(hydraulic), Path("portable.fmu"))
"""


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def token(path: Path) -> str:
    description = read_model_description(str(path))
    return str(description.guid or description.instantiationToken)


def test_rebuilt_in_another_process(version: int, tmp_path: Path) -> None:
    root = Path(__file__).parents[3]
    subprocess.run(
        [sys.executable, "-c", OTHER_PROCESS, str(version)],
        cwd=tmp_path,
        env={"PYTHONPATH": str(root), "PATH": "/usr/bin:/bin", "PYTHONHASHSEED": "7"},
        check=True,
    )
    assert digest(tmp_path / "native.fmu") == digest(cached_fmu(hydraulic, version))
    assert digest(tmp_path / "portable.fmu") == digest(cached_fmu(hydraulic, 2, portable=True))


def test_rebuilt_here(version: int, tmp_path: Path) -> None:
    compiler = find_targets()
    assert compiler is not None
    for name in ("a.fmu", "b.fmu"):
        write_native_fmu(native_content(oscillator, version), compiler, tmp_path / name)
    assert digest(tmp_path / "a.fmu") == digest(tmp_path / "b.fmu")


def test_another_default_is_another_token(version: int) -> None:
    first, *others = oscillator.parameters
    changed = replace(oscillator, parameters=(replace(first, value=2.5), *others))
    assert native_content(changed, version).token != native_content(oscillator, version).token


def test_versions_have_tokens_of_their_own() -> None:
    paths = [cached_fmu(oscillator, 2), cached_fmu(oscillator, 3)]
    paths.append(cached_fmu(oscillator, 2, portable=True))
    assert len({token(path) for path in paths}) == 3


def test_entries_carry_no_trace_of_time_or_machine(version: int) -> None:
    with zipfile.ZipFile(cached_fmu(oscillator, version)) as archive:
        names = archive.namelist()
        assert all(entry.date_time == (1980, 1, 1, 0, 0, 0) for entry in archive.infolist())
        text = b"".join(archive.read(name) for name in names)
    assert names[0] == "modelDescription.xml"
    assert str(Path(__file__).parents[3]).encode() not in text
