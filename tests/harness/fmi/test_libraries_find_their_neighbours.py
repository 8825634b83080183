"""A library that needs others which its FMU brings along is loaded, wherever they are, and given
back; nothing is looked for outside the FMU."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi.fmu import Fmu
from tests.harness.simulation.fmus import compiled, needs_compiler

pytestmark = [needs_compiler, pytest.mark.skipif(sys.platform != "linux", reason="ELF")]
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="needy" guid="{1}">
  <CoSimulation modelIdentifier="needy"/>
  <ModelVariables><ScalarVariable name="y" valueReference="1" causality="output"
    initial="calculated"><Real/></ScalarVariable></ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs>
    <InitialUnknowns><Unknown index="1"/></InitialUnknowns></ModelStructure>
</fmiModelDescription>
"""
NEEDY = """
#include <stddef.h>
double middle_value(void);
void *fmi2Instantiate(void) { return "x"; }
void fmi2FreeInstance(void *m) {}
int fmi2SetupExperiment(void *m) { return 0; }
int fmi2EnterInitializationMode(void *m) { return 0; }
int fmi2ExitInitializationMode(void *m) { return 0; }
int fmi2DoStep(void *m) { return 0; }
int fmi2Terminate(void *m) { return 0; }
int fmi2GetReal(void *m, const unsigned *r, size_t n, double *y) { *y = middle_value(); return 0; }
"""
MIDDLE = "double deep_value(void); double middle_value(void) { return 1.0 + deep_value(); }"
DEEP = "double deep_value(void) { return 41.0; }"


def build(folder: Path, where: str, *, soname: bool, by_path: bool) -> Path:
    """needy.so needs libmiddle.so, which needs libdeep.so; `where` in the FMU both lie."""
    sources = {"deep": DEEP, "middle": MIDDLE, "needy": NEEDY}
    for name, text in sources.items():
        (folder / f"{name}.c").write_text(text)
    for name, needed in (("deep", None), ("middle", "deep"), ("needy", "middle")):
        library = "needy.so" if name == "needy" else f"lib{name}.so"
        flags = [f"-Wl,-soname,{library}"] if soname and name != "needy" else []
        if needed:
            flags += [f"./lib{needed}.so"] if by_path else ["-L.", f"-l{needed}"]
        compiled(folder / f"{name}.c", folder / library, flags)
    made = folder / "needy.fmu"
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(folder / "needy.so", "binaries/linux64/needy.so")
        for name in ("middle", "deep"):
            archive.write(folder / f"lib{name}.so", f"{where}/lib{name}.so")
    return made


@pytest.mark.parametrize("where", ["binaries/linux64", "resources", "resources/lib/deep"])
@pytest.mark.parametrize(("soname", "by_path"), [(True, False), (False, False), (False, True)])
def test_dependencies_of_dependencies(
    tmp_path: Path, where: str, soname: bool, by_path: bool
) -> None:
    with Fmu(build(tmp_path, where, soname=soname, by_path=by_path)) as fmu:
        folder = str(fmu.folder)
        with fmu.instantiate("x") as instance:
            assert instance.get("y") == 42.0
    maps = Path("/proc/self/maps").read_text()
    assert folder not in maps  # all three are unloaded again


def test_what_is_not_in_the_fmu_is_not_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = build(tmp_path, "elsewhere", soname=True, by_path=False)
    bare = tmp_path / "bare.fmu"
    with zipfile.ZipFile(made) as source, zipfile.ZipFile(bare, "w") as target:
        for name in source.namelist():
            if "elsewhere" not in name:
                target.writestr(name, source.read(name))
    monkeypatch.chdir(tmp_path)  # where the libraries lie
    with (
        Fmu(bare) as fmu,
        pytest.raises(FmuError, match=r"needy\.so .* libmiddle\.so, which is not inst"),
    ):
        fmu.instantiate("x")


def test_folders_of_dead_processes_are_swept(tmp_path: Path) -> None:
    """One that a killed process left behind goes at the next start; those of the living stay."""
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    make = "from harness.fmi.archive.temporary import make_folder; print(make_folder())"
    kill = f"{make}; import os; os.kill(os.getpid(), 9)"
    subprocess.run([sys.executable, "-c", kill], env=environment, check=False, capture_output=True)
    (left,) = tmp_path.iterdir()
    (left / "file").write_text("x")
    alive = tmp_path / f"fmu-harness-{os.getpid()}-alive"
    other = tmp_path / "fmu-harness-notes"
    alive.mkdir()
    other.mkdir()
    subprocess.run([sys.executable, "-c", make], env=environment, check=True, capture_output=True)
    assert alive.is_dir() and other.is_dir() and not left.exists()
