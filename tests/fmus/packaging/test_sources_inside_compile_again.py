"""Whoever gets an FMU can compile it again from the archive alone, and gets the same numbers."""

import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3ScheduledExecution, FMU3Slave

from fmus.packaging.compiler import find_compiler, running_platform
from fmus.packaging.plant.build import cached_fmu
from fmus.plant import Plant
from tests.fmus.packaging.plants import ALL, hydraulic

KINDS = ("ModelExchange", "CoSimulation")
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]


def cc(arguments: list[str], folder: Path) -> None:
    compiler = find_compiler()
    assert compiler is not None
    subprocess.run([*compiler.command, *arguments], cwd=folder, check=True)


def declared_sources(archive: Path, version: int) -> list[str]:
    """The source files that the unpacked FMU declares, for each of its interface types."""
    if version == 2:
        root = ElementTree.parse(archive / "modelDescription.xml").getroot()
        groups = [root.findall(f"{kind}/SourceFiles/File") for kind in KINDS]
        assert all(groups)
        return sorted({file.attrib["name"] for group in groups for file in group})
    root = ElementTree.parse(archive / "sources" / "buildDescription.xml").getroot()
    return [file.attrib["name"] for file in root.iter("SourceFile")]


def test_recompiled_fmu_gives_the_same_run(version: int, tmp_path: Path) -> None:
    original = cached_fmu(hydraulic, version)
    with zipfile.ZipFile(original) as archive:
        archive.extractall(tmp_path / "fmu")
    target = running_platform()
    binary = tmp_path / "fmu" / "binaries" / target.folder(version) / f"hydraulic{target.suffix}"
    binary.unlink()
    flags = ["-O2", "-ffp-contract=off", "-shared", "-fPIC"]
    prefix = ["-DFMI3_OVERRIDE_FUNCTION_PREFIX"] if version == 3 else []
    sources = declared_sources(tmp_path / "fmu", version)
    cc([*flags, *prefix, *sources, "-o", str(binary), "-lm"], tmp_path / "fmu" / "sources")
    runs = [
        simulate_fmu(str(path), fmi_type="CoSimulation", start_values={"command": 50.0})
        for path in (original, tmp_path / "fmu")
    ]
    assert all(np.array_equal(runs[0][name], runs[1][name]) for name in runs[0].dtype.names)


@pytest.mark.parametrize("plant", ALL, ids=lambda plant: plant.name)
def test_no_warning_of_the_compiler(plant: Plant, version: int, tmp_path: Path) -> None:
    with zipfile.ZipFile(cached_fmu(plant, version)) as archive:
        archive.extractall(tmp_path)
    cc([*STRICT, "all.c"], tmp_path / "sources")


def test_exactly_the_functions_of_the_standard_are_visible(version: int, tmp_path: Path) -> None:
    """FMPy's classes list the functions; the library exports these and nothing else."""
    classes = {2: (FMU2Model, FMU2Slave), 3: (FMU3Model, FMU3Slave, FMU3ScheduledExecution)}
    standard = {n for c in classes[version] for n in dir(c) if n.startswith(f"fmi{version}")}
    with zipfile.ZipFile(cached_fmu(hydraulic, version)) as archive:
        archive.extractall(tmp_path)
    (library,) = (tmp_path / "binaries").rglob("*.*")
    nm = shutil.which("nm")
    if nm is None:
        pytest.skip("no nm")
    listing = subprocess.run([nm, "-D", "--defined-only", library], capture_output=True, text=True)
    assert {line.split()[-1] for line in listing.stdout.splitlines()} == standard


def test_static_linking_prefixes_every_function(version: int, tmp_path: Path) -> None:
    """Two FMUs in one static program: no symbol twice. (FMI 2 has the importer ask for it.)"""
    prefix = ["-DFMI2_FUNCTION_PREFIX"] if version == 2 else []
    objects = []
    for plant in ALL[:2]:
        with zipfile.ZipFile(cached_fmu(plant, version)) as archive:
            archive.extractall(tmp_path / plant.name)
        objects.append(tmp_path / f"{plant.name}.o")
        sources = tmp_path / plant.name / "sources"
        cc([*prefix, "-c", "all.c", "-o", str(objects[-1])], sources)
    names = [f"{plant.name}_fmi{version}GetVersion" for plant in ALL[:2]]
    (tmp_path / "main.c").write_text(
        "".join(f"const char *{name}(void);\n" for name in names)
        + f"int main(void) {{ return {names[0]}()[0] != {names[1]}()[0]; }}\n"
    )
    program = tmp_path / "program"
    cc(["main.c", *map(str, objects), "-lm", "-o", str(program)], tmp_path)
    assert subprocess.run([str(program)], check=False).returncode == 0
