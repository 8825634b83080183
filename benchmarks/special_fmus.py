"""FMUs that are hard on one thing: a description of 20 000 variables, a message in each step."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

from benchmarks.lag import OPTIONS, SOURCES

VARIABLES = 20_000
_ONE = (
    '    <ScalarVariable name="part{0}.quantity{1}" valueReference="{2}" causality="local" '
    'variability="continuous" description="Quantity {1} of part {0}">\n'
    '      <Real unit="N"/>\n    </ScalarVariable>\n'
)


def wide_fmu(folder: Path) -> Path:
    """The lag of the benchmarks (FMI 2) with `VARIABLES` local variables besides."""
    description = (SOURCES / "modelDescription_2.xml").read_text()
    units = '  <UnitDefinitions>\n    <Unit name="N"/>\n  </UnitDefinitions>\n'
    description = description.replace("  <ModelVariables>\n", units + "  <ModelVariables>\n")
    more = "".join(_ONE.format(i // 100, i % 100, i + 2) for i in range(VARIABLES))
    return _packed(
        folder, "wide", description.replace("  </ModelVariables>", more + "  </ModelVariables>")
    )


def talkative_fmu(folder: Path) -> Path:
    """The lag, which sends its logger a message in each step."""
    return _packed(
        folder, "talkative", (SOURCES / "modelDescription_2.xml").read_text(), "-DTALKATIVE"
    )


def _packed(folder: Path, name: str, description: str, *options: str) -> Path:
    library, fmu = folder / f"{name}.so", folder / f"{name}.fmu"
    shared = ("-fPIC", "-shared", "-fvisibility=hidden", *options)
    subprocess.run([*OPTIONS, *shared, str(SOURCES / "fmi2.c"), "-o", str(library)], check=True)
    with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(library, "binaries/linux64/lag.so")
    return fmu
