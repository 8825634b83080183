"""The trivial FMU and the bare C program that closes a loop around it, compiled from `c/`."""

from __future__ import annotations

import subprocess
import zipfile
from dataclasses import dataclass
from pathlib import Path

from benchmarks.pi import KI, KP, REFERENCE, STEP
from harness.fmi.binding.library import platform_tuple

SOURCES = Path(__file__).with_name("c")
OPTIONS = ("cc", "-std=c11", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror")


@dataclass(frozen=True)
class Lag:
    """What was built: the archive, and the library that is in it."""

    fmi_version: int
    fmu: Path
    library: Path

    def program(self, loops: int) -> Path:
        """The bare C program for so many closed loops, compiled where it is not there yet."""
        program = self.library.with_name(f"closed_loop_{loops}")
        if not program.exists():
            constants = {"REFERENCE": REFERENCE, "KP": KP, "KI": KI, "STEP_NS": round(STEP * 1e9)}
            constants |= {"FMI": self.fmi_version, "LOOPS": loops}
            defined = [f"-D{name}={value!r}" for name, value in constants.items()]
            _run(*OPTIONS, *defined, SOURCES / "closed_loop.c", "-o", program)
        return program


def build_lag(folder: Path, fmi_version: int) -> Lag:
    """Compile and package into `folder`; needs `cc`."""
    place = folder / f"lag_fmi{fmi_version}"
    place.mkdir()
    library, fmu = place / "lag.so", place / "lag.fmu"
    source = SOURCES / f"fmi{fmi_version}.c"
    _run(*OPTIONS, "-fPIC", "-shared", "-fvisibility=hidden", source, "-o", library)
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.write(SOURCES / f"modelDescription_{fmi_version}.xml", "modelDescription.xml")
        binaries = "linux64" if fmi_version == 2 else platform_tuple()
        archive.write(library, f"binaries/{binaries}/lag.so")
    return Lag(fmi_version, fmu, library)


def _run(*command: str | Path) -> None:
    subprocess.run(list(map(str, command)), check=True)
