"""Packages for the tests: written as folders or archives, with FMUs that are described only."""

import re
import zipfile
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

from harness.fmi.description.model_description import ModelDescription
from harness.ssp.flatten import FlatWire, flat_wires
from harness.ssp.package import open_package
from harness.ssp.ports import Ports
from harness.ssp.start_values import start_values
from harness.ssp.tree import Tree, build_tree
from harness.system.block import Block
from tests.harness.master.mock import Input, MockFmu, Output

NAMESPACES = " ".join(
    f'xmlns:{prefix}="http://ssp-standard.org/SSP1/SystemStructure{name}"'
    for prefix, name in {
        "ssd": "Description", "ssc": "Common", "ssv": "ParameterValues",
        "ssm": "ParameterMapping", "ssb": "SignalDictionary",
    }.items()
)  # fmt: skip

UNITS = """<ssd:Units>
  <ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit>
  <ssc:Unit name="mm"><ssc:BaseUnit m="1" factor="0.001"/></ssc:Unit>
  <ssc:Unit name="K"><ssc:BaseUnit K="1"/></ssc:Unit>
  <ssc:Unit name="degF">
    <ssc:BaseUnit K="1" factor="0.5555555555555556" offset="255.3722222222222"/>
  </ssc:Unit>
</ssd:Units>"""

WAY_OUT = re.compile(
    r"; .*\b(add|choose|connect|did you mean|divide|give|have it exported|leave|legal names|let|"
    r"lower|mend|must be|name|nest fewer|only .* may|pack|put|take|there are none|write)\b"
)
"""How the sentence of a refusal ends."""


def ssd(inner: str, more: str = "", *, name: str = "test", version: str = "1.0") -> str:
    """A description with `inner` in its root system and `more` after it."""
    return (
        f'<ssd:SystemStructureDescription {NAMESPACES} name="{name}" version="{version}">'
        f'<ssd:System name="root">{inner}</ssd:System>{more}</ssd:SystemStructureDescription>'
    )


def component(name: str, connectors: str = "", more: str = "", source: str = "a.fmu") -> str:
    inside = f"<ssd:Connectors>{connectors}</ssd:Connectors>" if connectors else ""
    return f'<ssd:Component name="{name}" source="{source}">{inside}{more}</ssd:Component>'


def connector(name: str, kind: str, inner: str = "") -> str:
    return f'<ssd:Connector name="{name}" kind="{kind}">{inner}</ssd:Connector>'


def wire(start: str, end: str, inner: str = "", more: str = "") -> str:
    """A connection between "element.connector" or "connector" ends."""
    ends = []
    for side, text in (("start", start), ("end", end)):
        element, dot, name = text.rpartition(".")
        ends.append((f'{side}Element="{element}" ' if dot else "") + f'{side}Connector="{name}"')
    return f"<ssd:Connection {' '.join(ends)} {more}>{inner}</ssd:Connection>"


def folder(path: Path, files: Mapping[str, str | bytes]) -> Path:
    """An unpacked package of these files; FMUs that are named `a.fmu` are there as empty files."""
    for name, content in {"a.fmu": b"", **files}.items():
        target = path / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def archive(path: Path, files: Mapping[str, str | bytes]) -> Path:
    with zipfile.ZipFile(path, "w") as made:
        for name, content in files.items():
            made.writestr(name, content)
    return path


SMALL = MockFmu(
    (Input("u"), Input("v"), Input("n", "Integer"), Input("b", "Boolean"), Input("mm", unit="mm")),
    (Output("y"), Output("z"), Output("i", "Integer"), Output("f", "Boolean"),
     Output("m", unit="m")),
).description  # fmt: skip


class Read:
    """A package that has been read with every FMU described as `description`."""

    def __init__(self, path: Path, description: ModelDescription = SMALL) -> None:
        with ExitStack() as stack:
            package = stack.enter_context(open_package(path))
            self.tree: Tree = build_tree(package, next(iter(package.structures)), stack)
            self.ports = Ports(self.tree, lambda source: description)
            self.wires: tuple[FlatWire, ...] = flat_wires(self.ports)
            found = start_values(self.ports, self.wires)
        self.starts = {".".join(path): values for path, values in found.items()}

    def paths(self) -> dict[str, str]:
        """Sources by target."""
        return {str(one.target): str(one.source) for one in self.wires if one.driven}


def described_only(target: Path, block: Block, name: str) -> Path:
    """An FMU of a block that has a description and no library."""
    signals = [*((s, "input") for s in block.inputs), *((s, "output") for s in block.outputs)]
    variables = "".join(
        f'<ScalarVariable name="{s.name}" valueReference="{i}" causality="{causality}" '
        f"{'' if causality == 'input' else 'initial=' + chr(34) + 'exact' + chr(34)}>"
        f'<Real start="{s.start!r}"/></ScalarVariable>'
        for i, (s, causality) in enumerate(signals)
    )
    outputs = "".join(
        f'<Unknown index="{i + 1}"/>' for i, (_, c) in enumerate(signals) if c == "output"
    )
    made = target / f"{name}.fmu"
    xml = (
        f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{{{name}}}">'
        f'<CoSimulation modelIdentifier="{name}"/><ModelVariables>{variables}</ModelVariables>'
        f"<ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}"
        "</InitialUnknowns></ModelStructure></fmiModelDescription>"
    )
    with zipfile.ZipFile(made, "w") as opened:
        opened.writestr(zipfile.ZipInfo("modelDescription.xml", (1980, 1, 1, 0, 0, 0)), xml)
    return made
