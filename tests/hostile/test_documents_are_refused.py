"""Every hostile modelDescription.xml is refused in one sentence, quickly; odd good ones are not."""

import re
import resource
import zipfile
from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi.fmu import Fmu
from tests.hostile.build import description
from tests.hostile.documents import BYTES, CHANGES, HARMLESS


def fmu_of(folder: Path, document: bytes, **members: bytes) -> Path:
    path = folder / "case.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", document)
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def refused(path: Path, words: str) -> None:
    with pytest.raises(FmuError, match=words) as caught:
        Fmu(path)
    text = str(caught.value)
    assert str(path) in text and text.isprintable() and len(text) < 1200
    assert re.search(r"; (mend the document, or|--no-validate)|: have the FMU exported", text)


@pytest.mark.parametrize("case", CHANGES)
def test_document(tmp_path: Path, case: str) -> None:
    fmi, old, new, words = CHANGES[case]
    good = description(fmi)
    assert old in good
    refused(fmu_of(tmp_path, good.replace(old, new, 1 + (case == "wrong root")).encode()), words)


@pytest.mark.parametrize("case", HARMLESS)
def test_what_changes_no_value_is_told_only(tmp_path: Path, case: str) -> None:
    fmi, old, new, words = HARMLESS[case]
    good = description(fmi)
    assert old in good
    with Fmu(fmu_of(tmp_path, good.replace(old, new, 1).encode())) as fmu:
        assert re.search(words, " ".join(fmu.notes)), fmu.notes


@pytest.mark.parametrize("case", BYTES)
def test_bytes(tmp_path: Path, case: str) -> None:
    document, words = BYTES[case]
    refused(fmu_of(tmp_path, document), words)


@pytest.mark.parametrize("text", ["<!DOCTYPE a [<!ENTITY b 'c'>]><fmiBuildDescription/>", "<a", ""])
def test_build_description(tmp_path: Path, text: str) -> None:
    members = {"sources/buildDescription.xml": text.encode()}
    refused(fmu_of(tmp_path, description(3).encode(), **members), "DOCTYPE|cannot be read")


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "iso-8859-1"])
def test_encodings_that_xml_knows_are_read(tmp_path: Path, fmi: int, encoding: str) -> None:
    stated = encoding.removesuffix("-sig")
    text = description(fmi).replace("UTF-8", stated).replace('name="u"', 'name="Öffnung"')
    with Fmu(fmu_of(tmp_path, text.encode(encoding))) as fmu:
        assert "Öffnung" in fmu.description.variables


def test_aliases_of_fmi_2_are_legal(tmp_path: Path) -> None:
    alias = '<ScalarVariable name="same" valueReference="1"><Real/></ScalarVariable>'
    text = description(2).replace("</ModelVariables>", alias + "</ModelVariables>")
    with Fmu(fmu_of(tmp_path, text.encode())) as fmu:
        assert fmu.description.variable("same").value_reference == 1


@pytest.mark.parametrize("size", [0, 10**7])
def test_sizes_allocate_nothing(tmp_path: Path, size: int) -> None:
    array = (
        '<Float64 name="a" valueReference="9" causality="parameter" variability="fixed" '
        f'start="1"><Dimension start="{size}"/></Float64>'
    )
    text = description(3).replace("</ModelVariables>", array + "</ModelVariables>")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with Fmu(fmu_of(tmp_path, text.encode())) as fmu:
        assert fmu.description.variable("a").size == size
        assert ("a[1]" in fmu.description.elements) is (size > 0)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000  # kB
