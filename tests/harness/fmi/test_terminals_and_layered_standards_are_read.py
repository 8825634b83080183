"""Terminals and manifests of layered standards are read; what is wrong with them stops nobody."""

import json
import re
import zipfile
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.fmi.description.model_description import LayeredStandard, Member
from harness.fmi.fmu import Fmu
from tests.hostile.build import description

TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
SOUND = """<fmiTerminalsAndIcons fmiVersion="3.0"><Terminals>
  <Terminal name="flange" matchingRule="plug" terminalKind="rotational" description="a shaft">
    <TerminalMemberVariable variableName="u" memberName="tau" variableKind="inflow"/>
    <Terminal name="sensor" matchingRule="bus">
      <TerminalMemberVariable variableName="y" variableKind="signal"/></Terminal>
  </Terminal></Terminals></fmiTerminalsAndIcons>"""
MANIFEST = """<fmiLayeredStandardManifest xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"
  fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-bus" fmi-ls:fmi-ls-version="1.0.0"
  fmi-ls:fmi-ls-description="Buses"/>"""


def fmu_with(folder: Path, terminals: str = SOUND, manifest: str = MANIFEST) -> Path:
    path = folder / "shaft.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description(3))
        archive.writestr(TERMINALS, terminals)
        archive.writestr("extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml", manifest)
    return path


def test_all_of_it_is_read(tmp_path: Path) -> None:
    with Fmu(fmu_with(tmp_path)) as fmu:
        (flange,) = fmu.description.terminals
        assert (flange.name, flange.matching_rule, flange.kind) == ("flange", "plug", "rotational")
        assert flange.members == (Member("u", "tau", "inflow"),)
        assert flange.terminals[0].members == (Member("y", "y", "signal"),)
        standard = LayeredStandard("org.fmi-standard.fmi-ls-bus", "1.0.0", "Buses")
        assert fmu.description.layered_standards == (standard,) and fmu.notes == ()


def test_info_shows_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["info", str(fmu_with(tmp_path))]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "layered standard org.fmi-standard.fmi-ls-bus 1.0.0 (Buses)" in shown
    assert "flange rotational plug tau = u a shaft flange.sensor bus y" in shown
    assert run_command_line(["info", "--json", str(fmu_with(tmp_path))]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["terminals"][0]["members"][0]["variable"] == "u"
    assert data["layered_standards"][0]["version"] == "1.0.0"


@pytest.mark.parametrize(
    ("terminals", "words"),
    [
        (SOUND.replace('"u"', '"w"'), "terminal 'flange' with the variable 'w', which does not"),
        (SOUND.replace("matchingRule", "rule"), "not valid: .*matchingRule.* is required"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]>" + SOUND, "left out: .* has a DOCTYPE"),
        ("<a", "left out: .* cannot be read"),
    ],
)
def test_a_fault_is_told(tmp_path: Path, terminals: str, words: str) -> None:
    with Fmu(fmu_with(tmp_path, terminals)) as fmu:
        assert fmu.description.variables and len(fmu.notes) == 1
        assert re.search(words, fmu.notes[0]), fmu.notes


def test_a_manifest_that_is_none_is_left_out(tmp_path: Path) -> None:
    with Fmu(fmu_with(tmp_path, manifest="<!DOCTYPE a><a/>")) as fmu:
        assert fmu.description.layered_standards == () and "DOCTYPE" in fmu.notes[0]
