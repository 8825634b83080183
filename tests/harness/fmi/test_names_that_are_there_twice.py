"""A name of several variables ends no run where they are local and nothing refers to them."""

from pathlib import Path

import pytest

from harness.bench import Bench
from harness.errors import FmuError, HarnessError
from harness.fmi.fmu import Fmu
from tests.harness.fmi.archives import rewritten
from tests.hostile.build import description, hostile_fmu

END = "\n  </ModelVariables>"


def variable(fmi: int, reference: int, causality: str = "local", name: str = "x") -> str:
    if fmi == 3:
        start = '" start="0' if causality == "input" else ""
        return (
            f'<Float64 name="{name}" valueReference="{reference}" causality="{causality}{start}"/>'
        )
    start = 'start="0"' if causality == "input" else ""
    own = f'name="{name}" valueReference="{reference}" causality="{causality}"'
    return f"<ScalarVariable {own}><Real {start}/></ScalarVariable>"


def changed(folder: Path, fmi: int, more: str, *replaced: str) -> Path:
    text = description(fmi).replace(END, more + END)
    if replaced:
        assert replaced[0] in text
        text = text.replace(*replaced)
    source = hostile_fmu(folder, fmi=fmi)
    return rewritten(source, folder / "twice.fmu", modelDescription_dot_xml=text.encode())


@pytest.mark.parametrize("fmi", [2, 3])
def test_local_ones_run_and_are_told(tmp_path: Path, fmi: int) -> None:
    path = changed(tmp_path, fmi, variable(fmi, 8) + variable(fmi, 9) + variable(fmi, 10))
    bench = Bench(stop_time=0.1, step=0.01)
    bench.fmu("plant", path)
    result = bench.run()
    assert [c.name for c in result.columns] == ["plant.y"] and len(result.time) == 11
    told = " ".join(result.manifest.notes)
    assert told.count('the variable name "x" twice: local variables that are left out') == 1


@pytest.mark.parametrize("fmi", [2, 3])
def test_whoever_refers_to_one_is_refused(tmp_path: Path, fmi: int) -> None:
    bench = Bench(stop_time=0.1, step=0.01)
    bench.fmu("plant", changed(tmp_path, fmi, variable(fmi, 8) + variable(fmi, 9)))
    bench.connect("plant.x", "plant.u")
    with pytest.raises(HarnessError, match=r"plant.*'?x'?"):
        bench.run()


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("causality", ["input", "parameter"])
def test_others_are_refused(tmp_path: Path, fmi: int, causality: str) -> None:
    both = variable(fmi, 8) + variable(fmi, 9, causality)
    if causality == "parameter":
        both = variable(fmi, 8) + variable(fmi, 9, "output")
    with pytest.raises(FmuError, match='the variable name "x" twice: it is not unique'):
        Fmu(changed(tmp_path, fmi, both))


def test_local_ones_to_which_the_structure_refers_are_refused(tmp_path: Path) -> None:
    both = variable(2, 8) + variable(2, 9)
    known = 'index="2" dependencies="5"'
    with pytest.raises(FmuError, match='the variable name "x" twice: it is not unique'):
        Fmu(changed(tmp_path, 2, both, 'index="2" dependencies=""', known))
