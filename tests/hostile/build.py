"""Builds the hostile FMU: compiled once a process and FMI version, packed anew for each behaviour.

    fmu = hostile_fmu(tmp_path, "DoStep segfault 5", "FreeInstance hang", fmi=2)

Behaviours are lines as `hostile_fmu.c` explains them. The model is a lag of the inputs `u`
and `load` with output `y` and parameter `T`, whose state can be serialised.
"""

from __future__ import annotations

import atexit
import shutil
import subprocess
import tempfile
import zipfile
from functools import cache
from pathlib import Path

from harness.fmi.binding.library import platform_tuple

SOURCE = Path(__file__).with_name("hostile_fmu.c")
OPTIONS = ("cc", "-std=c11", "-O1", "-w", "-fPIC", "-shared", "-fvisibility=hidden")

_VARIABLES_2 = """
    <ScalarVariable name="u" valueReference="0" causality="input" variability="continuous">
      <Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output" variability="continuous"
        initial="exact"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="T" valueReference="2" causality="parameter" variability="fixed"
        initial="exact"><Real start="0.1"/></ScalarVariable>
    <ScalarVariable name="load" valueReference="4" causality="input" variability="continuous">
      <Real start="0"/></ScalarVariable>"""
_VARIABLES_3 = """
    <Float64 name="time" valueReference="3" causality="independent" variability="continuous"/>
    <Float64 name="u" valueReference="0" causality="input" start="0"/>
    <Float64 name="y" valueReference="1" causality="output" initial="exact" start="0"/>
    <Float64 name="T" valueReference="2" causality="parameter" variability="fixed"
        initial="exact" start="0.1"/>
    <Float64 name="load" valueReference="4" causality="input" start="0"/>"""


def description(fmi: int, *, states: bool = True) -> str:
    """The modelDescription.xml; `states`: whether the FMU says that its state can be serialised."""
    version, token = ("2.0", "guid") if fmi == 2 else ("3.0", "instantiationToken")
    kind = "FMUstate" if fmi == 2 else "FMUState"
    can = f'canGetAndSet{kind}="true" canSerialize{kind}="true"' if states else ""
    structure = (
        '<Outputs><Unknown index="2" dependencies=""/></Outputs>'
        if fmi == 2
        else '<Output valueReference="1" dependencies=""/>'
    )
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="{version}" modelName="hostile" {token}="{{hostile}}">
  <CoSimulation modelIdentifier="hostile" canHandleVariableCommunicationStepSize="true" {can}/>
  <ModelVariables>{_VARIABLES_2 if fmi == 2 else _VARIABLES_3}
  </ModelVariables>
  <ModelStructure>{structure}</ModelStructure>
</fmiModelDescription>
"""


@cache
def library(fmi: int, *defined: str) -> Path:
    """The compiled library, with `-D` options such as "MISSING_SYMBOL"; removed at exit."""
    folder = Path(tempfile.mkdtemp(prefix="hostile-library-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    made = folder / "hostile.so"
    options = [*OPTIONS, f"-DFMI={fmi}", *(f"-D{one}" for one in defined)]
    subprocess.run([*options, str(SOURCE), "-o", str(made), "-lm", "-ldl", "-lpthread"], check=True)
    return made


def hostile_fmu(
    folder: Path,
    *behaviours: str,
    fmi: int = 3,
    name: str = "hostile",
    states: bool = True,
    defined: tuple[str, ...] = (),
) -> Path:
    """`folder/name.fmu`, which does what `behaviours` say."""
    binaries = "linux64" if fmi == 2 else platform_tuple()
    folder.mkdir(parents=True, exist_ok=True)
    made = folder / f"{name}.fmu"
    with zipfile.ZipFile(made, "w") as archive:
        content: dict[str, str | bytes] = {
            "modelDescription.xml": description(fmi, states=states),
            f"binaries/{binaries}/hostile.so": library(fmi, *defined).read_bytes(),
            "resources/behaviour.txt": "".join(f"{one}\n" for one in behaviours),
        }
        for member, text in content.items():  # without the time, so that equal FMUs have one hash
            archive.writestr(zipfile.ZipInfo(member), text)
    return made
