"""`info` shows what only some variables have: sizes, clocks, aliases, items, units for display."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import pytest

from harness.cli.main import run_command_line

VARIABLES = """
  <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
  <UInt64 name="n" valueReference="1" causality="structuralParameter" variability="fixed"
    start="2"/>
  <Float64 name="A" valueReference="2" causality="parameter" variability="fixed" min="-4"
    max="9" start="1 2 3 4 5 6"><Dimension valueReference="1"/><Dimension start="3"/></Float64>
  <Float64 name="T" valueReference="3" causality="output" unit="K" displayUnit="degC">
    <Alias name="temperature"/></Float64>
  <Enumeration name="mode" valueReference="4" causality="input" variability="discrete"
    declaredType="Mode" start="1"/>
  <Clock name="tick" valueReference="5" causality="input" intervalVariability="constant"
    intervalCounter="1" resolution="400"/>
  <Clock name="alarm" valueReference="6" causality="input" intervalVariability="triggered"/>
  <Int32 name="count" valueReference="7" causality="output" clocks="5"/>"""
DESCRIPTION = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="told" instantiationToken="{{told}}">
  <CoSimulation modelIdentifier="told" hasEventMode="true" fixedInternalStepSize="0.0025"/>
  <UnitDefinitions><Unit name="K"><BaseUnit K="1"/>
    <DisplayUnit name="degC" offset="-273.15"/></Unit></UnitDefinitions>
  <TypeDefinitions><EnumerationType name="Mode"><Item name="off" value="1"/>
    <Item name="on" value="2"/></EnumerationType></TypeDefinitions>
  <ModelVariables>{VARIABLES}
  </ModelVariables>
  <ModelStructure><Output valueReference="3"/><Output valueReference="7"/></ModelStructure>
</fmiModelDescription>
"""


@pytest.fixture
def told(tmp_path: Path) -> Path:
    """An FMU with binaries for two platforms, which nobody loads."""
    path = tmp_path / "told.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.writestr("binaries/x86_64-linux/told.so", b"")
        archive.writestr("binaries/x86_64-windows/told.dll", b"")
        archive.writestr("binaries/x86_64-darwin/readme.txt", b"")
        archive.writestr("sources/told.c", b"")
    return path


@pytest.mark.parametrize(
    "words",
    [
        "platforms x86_64-linux, x86_64-windows, source code",
        "co-simulation event mode, fixed internal step 0.0025 s",
        "tick input constant 1/400 s 0 s count",
        "alarm input triggered",
        "A Float64[n = 2 × 3] parameter fixed 1 2 3 4 5 6 -4 … 9",
        "T Float64 output continuous K (degC)",
        "mode Enumeration Mode input discrete 1 1 off, 2 on",
        "(alias of T)",
    ],
)
def test_the_table_has(
    told: Path, words: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert run_command_line(["info", str(told)]) == 0
    assert words in " ".join(capsys.readouterr().out.split())


def test_json_has_all_of_it(told: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["info", str(told), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["platforms"] == ["x86_64-linux", "x86_64-windows", "source code"]
    by_name = {v["name"]: v for v in data["variables"]}
    assert by_name["A"]["dimensions"] == ["n", 3] and by_name["A"]["shape"] == [2, 3]
    assert by_name["tick"]["details"]["interval"] == [1, 400]
    assert by_name["count"]["details"]["clocks"] == ["tick"]
    assert by_name["mode"]["details"]["items"] == [[1, "off"], [2, "on"]]
