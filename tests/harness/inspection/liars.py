"""Builds the FMUs of `liar.c` and `exchange_liar.c` with one of their faults."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

SOURCE = Path(__file__).with_name("liar.c")
EXCHANGE_SOURCE = Path(__file__).with_name("exchange_liar.c")

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


EXCHANGE_DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="spring" guid="{spring}"
    numberOfEventIndicators="1">
  <ModelExchange modelIdentifier="liar" canGetAndSetFMUstate="true" canSerializeFMUstate="true"
      providesDirectionalDerivative="true"/>
  <DefaultExperiment startTime="0" stopTime="2" stepSize="0.1"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input" variability="continuous">
      <Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output" variability="continuous">
      <Real/></ScalarVariable>
    <ScalarVariable name="x" valueReference="2" variability="continuous" initial="exact">
      <Real start="1"/></ScalarVariable>
    <ScalarVariable name="v" valueReference="3" variability="continuous" initial="exact">
      <Real start="0"/></ScalarVariable>
    <ScalarVariable name="der(x)" valueReference="4" variability="continuous">
      <Real derivative="3"/></ScalarVariable>
    <ScalarVariable name="der(v)" valueReference="5" variability="continuous">
      <Real derivative="4"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2" dependencies="3"/></Outputs>
    <Derivatives><Unknown index="5"/><Unknown index="6"/></Derivatives>
    <InitialUnknowns><Unknown index="2"/><Unknown index="5"/><Unknown index="6"/></InitialUnknowns>
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
    assert change[0] in DESCRIPTION
    text = DESCRIPTION.replace("CAPABILITIES", capabilities).replace(*change)
    return _built(folder, SOURCE, faults, text.replace("DEPENDENCIES", dependencies))


def exchange_liar(folder: Path, *faults: str) -> Path:
    """`folder/liar.fmu`, in model exchange, with the faults of `exchange_liar.c` that are named."""
    return _built(folder, EXCHANGE_SOURCE, faults, EXCHANGE_DESCRIPTION)


def _built(folder: Path, source: Path, faults: tuple[str, ...], description: str) -> Path:
    library, made = folder / "liar.so", folder / "liar.fmu"
    options = ["-O1", "-fPIC", "-shared", "-fvisibility=hidden", *(f"-D{one}" for one in faults)]
    subprocess.run(["cc", *options, str(source), "-o", str(library), "-lm"], check=True)
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(library, "binaries/linux64/liar.so")
    return made
