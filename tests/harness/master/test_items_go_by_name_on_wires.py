"""Two enumerations of the same items with other numbers are wired by name, or not at all where a
name is missing; a number that is no item of an enumeration is told."""

import zipfile
from pathlib import Path

import pytest

from harness import simulate
from harness.bench import Bench
from harness.errors import GraphError
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler

NAMES = {"2": ("o_in", "o_out"), "3": ("Enumeration_in", "Enumeration_out")}


def renumbered(folder: Path, kind: str, changes: dict[str, str]) -> Path:
    """A copy of the FMU of that kind with other text in its description."""
    made = folder / "other.fmu"
    with zipfile.ZipFile(model_fmu(kind)) as source, zipfile.ZipFile(made, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                for old, new in changes.items():
                    assert old.encode() in content
                    content = content.replace(old.encode(), new.encode())
            target.writestr(name, content)
    return made


def wired(kind: str, other: Path, **wire: object) -> Bench:
    given, found = NAMES[kind]
    bench = Bench(stop_time=0.3, step=0.1)
    bench.fmu("first", model_fmu(kind), start_values={given: "high"})
    bench.fmu("second", other)
    bench.connect(f"first.{found}", f"second.{given}", **wire)  # type: ignore[arg-type]
    return bench


@pytest.mark.parametrize("kind", NAMES)
def test_names_go_before_numbers(tmp_path: Path, kind: str) -> None:
    other = renumbered(tmp_path, kind, {'"high" value="7"': '"high" value="3"'})
    result = wired(kind, other).run()
    found = NAMES[kind][1]
    assert result[f"first.{found}"][-1] == 7 and result[f"second.{found}"][-1] == 3
    assert result.item_names(f"second.{found}")[-1] == "high"
    assert any(
        "items go by name" in note and "'high' 7 becomes 3" in note
        for note in result.manifest.notes
    )


@pytest.mark.parametrize("kind", NAMES)
def test_what_the_wire_says_goes_before_names(tmp_path: Path, kind: str) -> None:
    other = renumbered(tmp_path, kind, {'"high" value="7"': '"high" value="3"'})
    result = wired(kind, other, imperfections=[{"kind": "value_map", "table": [[7, 1]]}]).run()
    assert result.item_names(f"second.{NAMES[kind][1]}")[-1] == "low"
    assert not any("by name" in note for note in result.manifest.notes)


def test_a_name_that_is_missing_is_refused_with_the_way_out(tmp_path: Path) -> None:
    changes = {'"high" value="7"': '"high" value="3"', '"low"': '"idle"'}
    with pytest.raises(GraphError, match=r"'high' 7 becomes 3.*no item 'low'; put a value_map"):
        wired("2", renumbered(tmp_path, "2", changes)).run()


@pytest.mark.parametrize("kind", NAMES)
def test_a_number_that_is_no_item_is_told(tmp_path: Path, kind: str) -> None:
    found = NAMES[kind][1]
    other = renumbered(tmp_path, kind, {'"low" value="1"': '"low" value="2"'})
    result = simulate(other, stop_time=0.2, step_size=0.1, start_values={NAMES[kind][0]: "high"})
    assert not any("no item" in note for note in result.notes)
    bench = Bench(stop_time=0.3, step=0.1)
    bench.fmu("first", model_fmu(kind), start_values={NAMES[kind][0]: "high"})
    bench.fmu("second", model_fmu(kind))
    bench.connect(f"first.{found}", f"second.{NAMES[kind][0]}", factor=2.0)
    notes = bench.run().manifest.notes
    told = [note for note in notes if "no item of its enumeration" in note]
    assert any(f"second.{found} is 14 at t = " in note and "7 'high'" in note for note in told)
