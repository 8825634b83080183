"""Builds the FMU of `liar.c` with one of its faults."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

SOURCE = Path(__file__).with_name("liar.c")

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="liar" guid="{liar}">
  <CoSimulation modelIdentifier="liar" canHandleVariableCommunicationStepSize="true"
      canGetAndSetFMUstate="true" providesDirectionalDerivative="true" CAPABILITIES/>
  <DefaultExperiment startTime="0" stopTime="2" stepSize="0.1"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input" variability="continuous">
      <Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output" variability="continuous"
        initial="exact"><Real start="0"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2" dependencies="DEPENDENCIES"/></Outputs>
  </ModelStructure>
</fmiModelDescription>
"""


def liar(
    folder: Path,
    *faults: str,
    capabilities: str = "",
    dependencies: str = "",
    change: tuple[str, str] = ("", ""),
) -> Path:
    """`folder/liar.fmu` with the faults of `liar.c` that are named, and a change of its XML."""
    library, made = folder / "liar.so", folder / "liar.fmu"
    options = ["-O1", "-fPIC", "-shared", "-fvisibility=hidden", *(f"-D{one}" for one in faults)]
    subprocess.run(["cc", *options, str(SOURCE), "-o", str(library), "-lm"], check=True)
    assert change[0] in DESCRIPTION
    text = DESCRIPTION.replace("CAPABILITIES", capabilities).replace(*change)
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("modelDescription.xml", text.replace("DEPENDENCIES", dependencies))
        archive.write(library, "binaries/linux64/liar.so")
    return made
