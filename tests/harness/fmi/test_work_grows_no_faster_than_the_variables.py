"""Four times the variables take about four times the work: to open an FMU, to plan its run, to show
it and to write it as JSON."""

import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from harness import Bench, Fmu
from harness.cli.info import info_command
from harness.master.opened import opened
from harness.master.run import plan_system


def large_fmu(path: Path, count: int) -> Path:
    """FMI 2; every second variable is an output that depends on the input before it."""
    variables = "\n".join(
        f'<ScalarVariable name="part[{i}].{name}" valueReference="{i}" causality="{name}" '
        f'description="number {i}"><Real unit="m" {start}/></ScalarVariable>'
        for i in range(count)
        for name, start in ((("input", 'start="1"'), ("output", ""))[i % 2],)
    )
    unknowns = "".join(f'<Unknown index="{i + 1}" dependencies="{i}"/>' for i in range(1, count, 2))
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(
            "modelDescription.xml",
            '<fmiModelDescription fmiVersion="2.0" modelName="large" guid="1">'
            '<CoSimulation modelIdentifier="large"/>'
            '<UnitDefinitions><Unit name="m"/></UnitDefinitions>'
            f"<ModelVariables>{variables}</ModelVariables><ModelStructure>"
            f"<Outputs>{unknowns}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns>"
            "</ModelStructure></fmiModelDescription>",
        )
    return path


def open_only(path: Path) -> None:
    with Fmu(path) as fmu:
        assert fmu.description.outputs


def plan(path: Path) -> None:
    bench = Bench(stop_time=1.0)
    bench.fmu("plant", path)
    with opened(bench.system()) as fmus:
        plan_system(bench.system(), fmus)


def lines(work: Callable[[Path], None], path: Path) -> int:
    """The lines of Python that run, each turn of a loop anew."""
    count, before = 0, sys.gettrace()

    def trace(frame: FrameType, event: str, argument: object) -> Any:
        nonlocal count
        count += 1
        return trace

    sys.settrace(trace)
    try:
        work(path)
    finally:
        sys.settrace(before)
    return count


@pytest.mark.parametrize(
    "work", [open_only, plan, info_command, lambda path: info_command(path, as_json=True)],
    ids=["open", "plan", "show", "json"],
)  # fmt: skip
def test_work(tmp_path: Path, work: Callable[[Path], None]) -> None:
    few, many = (large_fmu(tmp_path / f"{count}.fmu", count) for count in (250, 1_000))
    work(few)  # what is imported and read once
    assert lines(work, many) < 5 * lines(work, few)
