"""A library that cannot be loaded says why (which platform, which dependency, which symbol) and
names the way out."""

import re
import struct
import subprocess
import zipfile
from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi.binding.library import platform_tuple
from harness.fmi.fmu import Fmu
from tests.hostile.build import description, hostile_fmu, library

HERE = platform_tuple()


def elf(machine: int, bits: int = 2, kind: int = 3) -> bytes:
    return (
        b"\x7fELF" + bytes([bits, 1, 1]) + bytes(9) + struct.pack("<HH", kind, machine) + bytes(60)
    )


def pe(machine: int) -> bytes:
    return b"MZ" + bytes(58) + struct.pack("<I", 64) + b"PE\0\0" + struct.pack("<H", machine)


def mach(*machines: int) -> bytes:
    if len(machines) == 1:
        return b"\xcf\xfa\xed\xfe" + struct.pack("<I", machines[0])
    table = b"".join(struct.pack(">I", machine) + bytes(16) for machine in machines)
    return b"\xca\xfe\xba\xbe" + struct.pack(">I", len(machines)) + table


FOREIGN = {
    "aarch64-linux": elf(183), "arm-linux": elf(40, 1), "x86-linux": elf(3, 1),
    "riscv64-linux": elf(243), "x86_64-windows": pe(0x8664), "x86-windows": pe(0x14C),
    "aarch64-darwin": mach(0x0100000C), "x86_64-darwin and aarch64-darwin":
    mach(0x01000007, 0x0100000C),
}  # fmt: skip


def fmu_with(folder: Path, content: bytes, place: str = HERE, name: str = "hostile.so") -> Path:
    path = folder / "case.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description(3))
        archive.writestr(f"binaries/{place}/{name}", content)
    return path


def refused(path: Path, words: str) -> None:
    with Fmu(path) as fmu, pytest.raises(FmuError, match=words) as caught:
        fmu.instantiate("plant")
    assert str(caught.value).isprintable()
    assert re.search(r"[;:] (have it|install|mend the|--compile)[^;:]*$", str(caught.value))


def compiled(folder: Path, source: str, *options: str) -> bytes:
    (folder / "made.c").write_text(source)
    made = folder / "made.so"
    command = ["cc", "-shared", "-fPIC", "-w", "-o", str(made), str(folder / "made.c"), *options]
    subprocess.run(command, check=True, cwd=folder)
    return made.read_bytes()


@pytest.mark.parametrize("platform", FOREIGN)
def test_another_machine_is_named(tmp_path: Path, platform: str) -> None:
    words = f"is built for {platform}, and this machine is {HERE}"
    refused(fmu_with(tmp_path, FOREIGN[platform]), words)


@pytest.mark.parametrize("content", [b"", b"no library", b"#!/bin/sh\n", bytes(100), b"\x7fELF"])
def test_what_is_no_library(tmp_path: Path, content: bytes) -> None:
    refused(fmu_with(tmp_path, content), "it is no library of any known kind")


@pytest.mark.skipif(HERE != "x86_64-linux", reason="the header is of that machine")
def test_a_program_is_no_shared_library(tmp_path: Path) -> None:
    refused(fmu_with(tmp_path, elf(62, kind=2)), "an ELF file but no shared library")


@pytest.mark.parametrize("part", [0.01, 0.3, 0.5])
def test_a_library_that_is_cut(tmp_path: Path, part: float) -> None:
    whole = library(3).read_bytes()
    refused(fmu_with(tmp_path, whole[: int(part * len(whole))]), "it is cut short")


def test_a_missing_dependency_is_named(tmp_path: Path) -> None:
    compiled(tmp_path, "int helper(void) { return 1; }", "-Wl,-soname,libvalves.so.3")
    (tmp_path / "made.so").rename(tmp_path / "libvalves.so")
    user = "int helper(void); int user(void) { return helper(); }"
    content = compiled(tmp_path, user, "-L.", "-lvalves", "-Wl,--no-as-needed")
    refused(fmu_with(tmp_path, content), "needs the library libvalves.so.3, which is not installed")


def test_a_missing_symbol_is_named(tmp_path: Path) -> None:
    content = compiled(tmp_path, "int valve_area(void); int user(void) { return valve_area(); }")
    refused(fmu_with(tmp_path, content), "needs the symbol valve_area, which nothing here provides")


@pytest.mark.parametrize("fmi", [2, 3])
def test_missing_functions_are_named_before_anything_is_called(tmp_path: Path, fmi: int) -> None:
    path = hostile_fmu(tmp_path, fmi=fmi, defined=("MISSING_SYMBOL",))
    refused(path, f"hostile.so of the FMU lacks the function fmi{fmi}Terminate, which the standard")
    empty = fmu_with(tmp_path, compiled(tmp_path, "int nothing;"))
    refused(empty, "lacks the functions fmi3InstantiateCoSimulation, fmi3EnterInit.*fmi3Free")


def test_platforms_that_are_there_are_named(tmp_path: Path) -> None:
    refused(fmu_with(tmp_path, b"", "win64", "hostile.dll"), "it has win64")
    refused(fmu_with(tmp_path, b"", HERE, "other.so"), "no library hostile.so .*has other.so inst")
    path = fmu_with(tmp_path, b"", "nowhere", "text.txt")
    refused(path, f"it has no libraries at all: have it exported for {HERE}")
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("sources/all.c", "")
    refused(path, r"it has no libraries at all \(and sources\): --compile builds one")
