"""What other tools write a little beside the standard means what they mean, with a note."""

import re
import zipfile
from pathlib import Path

import pytest

from harness.errors import ExperimentError
from harness.ssp.package import open_package
from harness.ssp.settings import fixed_step
from harness.ssp.to_experiment import open_experiment
from tests.harness.fmi.archives import oscillator_fmu, rewritten
from tests.harness.ssp.packages import UNITS, Read, archive, component, connector, folder, ssd

CONNECTORS = connector("u", "input") + connector("y", "output")
PLAIN = ssd(f"<ssd:Elements>{component('a', CONNECTORS)}</ssd:Elements>")
ALGORITHM = (
    "<ssd:Annotations><ssc:Annotation type='com.opensimulationplatform'><osp:Algorithm>"
    "<osp:FixedStepAlgorithm baseStepSize='1e-3'/></osp:Algorithm></ssc:Annotation>"
    "</ssd:Annotations>"
)


def test_a_well_known_prefix_needs_no_declaration(tmp_path: Path) -> None:
    text = ssd("", f"<ssd:DefaultExperiment>{ALGORITHM}</ssd:DefaultExperiment>")
    text = f"<?xml version='1.0'?><!-- <ssd:x> -->{text}".replace("xmlns:ssc=", "xmlns:other=")
    path = folder(tmp_path, {"SystemStructure.ssd": text})
    with pytest.warns(UserWarning, match="not declare the prefix ssc and osp"):  # noqa: SIM117
        with open_package(path) as package:
            assert fixed_step(package.structures["SystemStructure.ssd"]) == (
                1e-3,
                "com.opensimulationplatform",
            )


def test_an_unknown_prefix_is_refused(tmp_path: Path) -> None:
    path = folder(tmp_path, {"SystemStructure.ssd": ssd("<my:Thing/>")})
    with pytest.raises(ExperimentError, match="prefix my"), open_package(path):
        pass


def test_drafts_are_read_as_ssp_1(tmp_path: Path) -> None:
    draft = PLAIN.replace('version="1.0"', 'version="Draft20170606"')
    for name in ("Description", "Common"):
        new = f"http://ssp-standard.org/SSP1/SystemStructure{name}"
        draft = draft.replace(new, f"http://www.pmsf.net/xsd/SystemStructure{name}Draft")
    with pytest.warns(UserWarning, match="draft of SSP"):
        read = Read(folder(tmp_path / "draft", {"SystemStructure.ssd": draft}))
    plain = Read(folder(tmp_path / "plain", {"SystemStructure.ssd": PLAIN}))
    assert [node.element for node in read.tree.fmus] == [node.element for node in plain.tree.fmus]


@pytest.mark.parametrize("scheme", ["proxyfmu://localhost", "fmu-proxy://10.0.0.1:9090"])
def test_the_file_of_a_proxy_runs_here(tmp_path: Path, scheme: str) -> None:
    proxy = PLAIN.replace("a.fmu", f"{scheme}?file=a.fmu")
    with pytest.warns(UserWarning, match=r"a\.fmu runs here"):
        read = Read(folder(tmp_path, {"SystemStructure.ssd": proxy}))
    assert [node.source.name for node in read.tree.fmus] == ["a.fmu"]


@pytest.mark.parametrize("uri", ["proxyfmu://localhost", "proxyfmu://h?file=../x.fmu"])
@pytest.mark.filterwarnings("ignore:.*runs here")
def test_a_proxy_leads_nowhere_else(tmp_path: Path, uri: str) -> None:
    text = PLAIN.replace("a.fmu", uri)
    with pytest.raises(ExperimentError, match=r"no relative URI|leaves the package"):
        Read(archive(tmp_path / "p.ssp", {"SystemStructure.ssd": text}))


@pytest.mark.filterwarnings("ignore:.*states no")
def test_the_demanded_interface_is_taken(tmp_path: Path) -> None:
    text = PLAIN.replace(CONNECTORS, connector("position", "output")).replace(
        'source="a.fmu"', 'source="a.fmu" implementation="ModelExchange"'
    )
    files = {"SystemStructure.ssd": text, "a.fmu": oscillator_fmu(2).read_bytes()}
    with open_experiment(archive(tmp_path / "p.ssp", files)) as experiment:
        spec = experiment.variant_spec("test")
    assert spec.components["a"].interface_type == "model-exchange"  # type: ignore[union-attr]


@pytest.mark.parametrize("unit", ["[m]", "m"])
def test_a_unit_of_the_same_name_is_the_same(tmp_path: Path, unit: str) -> None:
    wrong = UNITS.replace('<ssc:BaseUnit m="1"/>', '<ssc:BaseUnit m="2"/>')
    value = (
        "<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
        f"<ssv:ParameterSet version='1.0' name='p'><ssv:Parameters><ssv:Parameter name='u'>"
        f"<ssv:Real value='3' unit='{unit}'/></ssv:Parameter></ssv:Parameters>"
        f"{wrong.replace('ssd:', 'ssv:')}</ssv:ParameterSet>"
        "</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"
    )
    one = component("a", connector("u", "input", '<ssc:Real unit="m"/>'), value)
    text = ssd(f"<ssd:Elements>{one}</ssd:Elements>", UNITS)
    with pytest.warns(UserWarning, match="taken as they are"):
        read = Read(folder(tmp_path, {"SystemStructure.ssd": text}))
    assert read.starts["a"]["u"] == 3.0


def test_the_default_step_of_an_fmu_is_shortened_to_divide_the_run(tmp_path: Path) -> None:
    with zipfile.ZipFile(oscillator_fmu(2)) as opened:
        text = opened.read("modelDescription.xml").decode()
    assert "stepSize=" in text
    odd = re.sub(r'stepSize="[^"]*"', 'stepSize="0.03333333333"', text).encode()
    path = rewritten(oscillator_fmu(2), tmp_path / "odd.fmu", modelDescription_dot_xml=odd)
    one = component("a", connector("position", "output"))
    files = {
        "SystemStructure.ssd": ssd(
            f"<ssd:Elements>{one}</ssd:Elements>", '<ssd:DefaultExperiment stopTime="1"/>'
        ),
        "a.fmu": path.read_bytes(),
    }
    with pytest.warns(UserWarning, match="default step"):  # noqa: SIM117
        with open_experiment(archive(tmp_path / "p.ssp", files)) as experiment:
            assert experiment.variant_spec("test").step == 0.03125
