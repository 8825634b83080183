"""`validate` finds what FMPy's validation finds, in little time, and cites the standard."""

from __future__ import annotations

import time
import zipfile
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

from harness.inspection.static import Problem, Severity, validate
from tests.hostile.build import description
from tests.hostile.documents import CHANGES, HARMLESS

_STRUCTURE = {
    "output that is not listed": (3, '<Output valueReference="1" dependencies=""/>', "", "lacks y"),
    "input that is listed": (2, '<Unknown index="2" dependencies=""/>', '<Unknown index="2"/>'
                             '<Unknown index="1"/>', "Outputs lists u, which it should not"),
    "initial unknown that is known": (
        3, '<Output valueReference="1" dependencies=""/>', '<Output valueReference="1"/>'
        '<InitialUnknown valueReference="1"/>', "InitialUnknowns lists y, which it should not"
    ),
    "derivative of nothing": (
        3, '<Output valueReference="1" dependencies=""/>', '<Output valueReference="1"/>'
        '<ContinuousStateDerivative valueReference="1"/>', "y is listed as derivative (line "
    ),
    "kinds of nothing": (
        2, 'index="2" dependencies=""', 'index="2" dependencies="1" dependenciesKind="fixed fixed"',
        "do not match for Output y"
    ),
}  # fmt: skip


def fmu_of(folder: Path, text: str) -> Path:
    path = folder / "case.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text)
    return path


def told(problems: tuple[Problem, ...]) -> set[str]:
    return {f"{p.place}: {p.text}" for p in problems}


@pytest.mark.parametrize("case", [*CHANGES, *HARMLESS, *_STRUCTURE])
def test_what_fmpy_finds(tmp_path: Path, case: str) -> None:
    fmi, old, new, _ = {**CHANGES, **HARMLESS, **_STRUCTURE}[case]
    good = description(fmi)
    sound = told(validate(fmu_of(tmp_path, good)))
    path = fmu_of(tmp_path, good.replace(old, new, 1 + (case == "wrong root")))
    if validate_fmu(str(path)):
        assert told(validate(path)) - sound


@pytest.mark.parametrize("case", _STRUCTURE)
def test_the_model_structure(tmp_path: Path, case: str) -> None:
    fmi, old, new, words = _STRUCTURE[case]
    path = fmu_of(tmp_path, description(fmi).replace(old, new))
    assert any(words in p.text for p in validate(path))


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(
    ("name", "legal"),
    [("a.b[1,2].c", True), ("der(a.b,2)", True), ("'a b'.x", True), ("_a9", True), ("a b", False),
     ("9a", False), ("a[x]", False), ("der(a", False), ("a.", False), ("ä", False)],
)  # fmt: skip
def test_structured_names(tmp_path: Path, fmi: int, name: str, legal: bool) -> None:
    convention = 'modelName="hostile" variableNamingConvention="structured"'
    text = description(fmi).replace('name="u"', f'name="{name}"')
    path = fmu_of(tmp_path, text.replace('modelName="hostile"', convention))
    found = [p for p in validate(path) if "no legal name" in p.text]
    assert (not found) == legal == (validate_fmu(str(path)) == [])
    assert all(p.severity is Severity.WARNING and name in p.place for p in found)


def test_each_finding_of_the_standard_cites_it(tmp_path: Path) -> None:
    text = description(2).replace('<Real start="0"/>', "<Integer/>", 1)
    problems = [p for p in validate(fmu_of(tmp_path, text)) if p.rule]
    assert {p.severity for p in problems} == {Severity.ERROR, Severity.WARNING}
    assert any('FMI 2.0, 2.2.7: if initial is "exact" or "approx"' in p.rule for p in problems)


def test_initial_unknowns_harm_nobody(tmp_path: Path) -> None:
    text = description(2).replace('initial="exact"><Real start="0"/>', "><Real/>")
    (found,) = [p for p in validate(fmu_of(tmp_path, text)) if "InitialUnknowns lacks y" in p.text]
    assert found.severity is Severity.NOTE and "2.2.8" in found.rule


def test_ten_thousand_variables_take_two_seconds(tmp_path: Path) -> None:
    many = "".join(
        f'<Float64 name="a.b[{i}]" valueReference="{i + 10}" causality="output" description="of"/>'
        for i in range(10_000)
    )
    text = description(3).replace("</ModelVariables>", many + "</ModelVariables>")
    path = fmu_of(tmp_path, text.replace("modelName", 'variableNamingConvention="flat" modelName'))
    began = time.process_time()
    assert any("lacks a.b[0]" in p.text and "9995 more" in p.text for p in validate(path))
    assert time.process_time() - began < 2.0
