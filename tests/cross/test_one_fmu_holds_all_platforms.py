"""`--targets all`: one FMU with a library for each platform, in the folders of its FMI version,
that shows the FMI functions and asks for the C library only."""

import re
import zipfile
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

from fmus.hybrid_actuator.model import plant
from harness.export.controller import controller_fmu
from tests.cross.mach_o import read
from tests.cross.machines import HAS_ZIG
from tests.harness.export.blocks import pid

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not HAS_ZIG, reason="needs ziglang"),
]
FOLDERS = {
    2: {"linux64", "aarch64-linux", "win64", "darwin64", "aarch64-darwin"},
    3: {"x86_64-linux", "aarch64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin"},
}
MADE_BY_THE_LINKER = {"__mh_dylib_header", "___dso_handle"}
MAC = {2: ("darwin64", "aarch64-darwin"), 3: ("x86_64-darwin", "aarch64-darwin")}


@pytest.fixture(params=["controller", "plant"])
def fmu(request: pytest.FixtureRequest, version: int) -> Path:
    if request.param == "plant":
        return plant.fmu(version, targets=["all"])
    return controller_fmu(pid(), "block", 0.01, version, targets=["all"])


@pytest.fixture(params=[2, 3])
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


def test_all_platforms(fmu: Path, version: int) -> None:
    assert validate_fmu(str(fmu)) == []
    with zipfile.ZipFile(fmu) as archive:
        binaries = {n: archive.read(n) for n in archive.namelist() if n.startswith("binaries/")}
    assert {name.split("/")[1] for name in binaries} == FOLDERS[version]
    for folder, cpu in zip(MAC[version], ("x86_64", "aarch64"), strict=True):
        (data,) = (d for name, d in binaries.items() if name.startswith(f"binaries/{folder}/"))
        library = read(data)
        assert (library.cpu, library.macos) == (cpu, "11.0")
        shown = library.exported - MADE_BY_THE_LINKER
        assert all(re.fullmatch(rf"_fmi{version}\w+", name) for name in shown)
        assert f"_fmi{version}DoStep" in library.exported
        assert library.libraries == ("/usr/lib/libSystem.B.dylib",)
        assert not any("fmi" in name or "part" in name for name in library.undefined)
