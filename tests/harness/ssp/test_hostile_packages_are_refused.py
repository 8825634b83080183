"""Packages of strangers end in one sentence, whatever they hold, and it names the way out."""

from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.errors import ExperimentError
from harness.ssp.to_experiment import open_experiment
from tests.harness.ssp.packages import NAMESPACES, WAY_OUT, archive, component, folder, ssd

ENTITY = '<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b SYSTEM "file:///etc/hostname">]>'


def refused(path: Path, words: str) -> None:
    with pytest.raises(ExperimentError, match=words) as caught, open_experiment(path):
        pass
    text = str(caught.value)
    assert WAY_OUT.search(text) and text.isprintable(), text


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (ENTITY + ssd("").replace("root", "&b;"), "DOCTYPE|Entity|entity"),
        (ENTITY + ssd(""), "has a DOCTYPE"),
        ("<my:System/>", "no readable XML"),
        ("", "no readable XML"),
        (f"<ssd:System {NAMESPACES} name='x'/>", "the root element is ssd:System, not"),
        (ssd("").replace(' name="root"', ""), "line 1: ssd:System lacks its attribute 'name'"),
        (ssd("").replace('version="1.0"', 'version="3.0"'), "version='3.0' is not legal"),
        (ssd("<ssd:Elements><ssd:Connector name='c' kind='input'/></ssd:Elements>"),
         "ssd:Connector may not stand in ssd:Elements"),
        (ssd("<a/>").replace(NAMESPACES, NAMESPACES + ' xmlns="no//uri"'),
         "line 1: .*a has no canonical form: every namespace must be an absolute URI"),
        (ssd("<ssd:System name='s'>" * 300 + "</ssd:System>" * 300), "Excessive depth"),
        (ssd("", "<ssd:DefaultExperiment stopTime='soon'/>"), "stopTime='soon' is no number"),
    ],
)  # fmt: skip
def test_documents(tmp_path: Path, content: str, words: str) -> None:
    refused(archive(tmp_path / "x.ssp", {"SystemStructure.ssd": content}), words)


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("../../a.fmu", "leaves the package"),
        ("%2e%2e/a.fmu", "leaves the package"),
        ("/etc/passwd", "is no relative URI"),
        ("file:///etc/passwd", "is no relative URI"),
        ("http://host/a.fmu", "is no relative URI"),
        ("resources/b.fmu", "there is no file 'resources/b.fmu'; did you mean 'resources/a.fmu'"),
    ],
)
def test_sources(tmp_path: Path, source: str, words: str) -> None:
    inner = f"<ssd:Elements>{component('c', source=source)}</ssd:Elements>"
    (tmp_path / "a.fmu").write_bytes(b"")
    files = {"SystemStructure.ssd": ssd(inner), "resources/a.fmu": b""}
    refused(archive(tmp_path / "x.ssp", files), words)


@pytest.mark.parametrize("member", ["../evil.ssd", "/evil.ssd"])
def test_archives(tmp_path: Path, member: str) -> None:
    files = {"SystemStructure.ssd": ssd(""), member: "x"}
    refused(archive(tmp_path / "x.ssp", files), r"SSP .* leaves its folder")
    wrapped = archive(tmp_path / "y.ssp", {"x/SystemStructure.ssd": ssd("")})
    refused(wrapped, r"has no SystemStructure\.ssd at its root")


def test_systems_that_contain_themselves(tmp_path: Path) -> None:
    one = "<ssd:Component name='{}' source='#me'/>"
    twice = f"<ssd:Elements>{one.format('a')}{one.format('b')}</ssd:Elements>"
    content = ssd(twice).replace('name="root"', 'name="root" id="me"')
    refused(folder(tmp_path, {"SystemStructure.ssd": content}), "would be a part of itself")


def test_descriptions_that_contain_themselves(tmp_path: Path) -> None:
    kind = "type='application/x-ssp-definition'"
    for name, other in (("SystemStructure", "other"), ("other", "SystemStructure")):
        inner = (
            f"<ssd:Elements><ssd:Component name='c' {kind} source='{other}.ssd'/></ssd:Elements>"
        )
        folder(tmp_path, {f"{name}.ssd": ssd(inner, name=name)})
    refused(tmp_path, "would be a part of itself")


def test_systems_that_double_on_each_level(tmp_path: Path) -> None:
    two = "<ssd:Component name='a' source='#s{0}'/><ssd:Component name='b' source='#s{0}'/>"
    levels = [f"<ssd:Elements>{two.format(i + 1)}</ssd:Elements>" for i in range(20)]
    systems = [
        f"<ssd:System name='s{i}' id='s{i}'>{inner}</ssd:System>"
        for i, inner in enumerate([*levels, ""])
    ]
    content = ssd(f"<ssd:Elements>{''.join(systems)}</ssd:Elements>")
    refused(folder(tmp_path, {"SystemStructure.ssd": content}), "more than 100000 elements")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ('{"seed": ', "is no JSON"),
        ("[1]", "holds no JSON object"),
        ('{"sead": 1}', "key 'sead'; did you mean 'seed'"),
        ('{"plots": {"../../x": {}}}', "is not fit for a file"),
    ],
)
def test_settings(tmp_path: Path, settings: str, words: str) -> None:
    annotation = (
        "<ssd:Annotations><ssc:Annotation type='fmu-harness.settings'>"
        f"<Settings xmlns='urn:fmu-harness:settings:1'>{settings}</Settings></ssc:Annotation>"
        "</ssd:Annotations>"
    )
    path = archive(tmp_path / "x.ssp", {"SystemStructure.ssd": ssd("", annotation)})
    refused(path, words)


def test_the_command_line_says_one_sentence(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "x.ssp"
    path.write_bytes(b"no archive")
    assert run_command_line(["run", str(path)]) == 2
    found = capsys.readouterr().err
    assert found.startswith("error: SSP") and "Traceback" not in found
