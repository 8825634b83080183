"""Reading 20 000 variables takes about ten times as long as 2 000, also where each has a fault."""

import time
from pathlib import Path

import pytest

from harness.fmi.description.reader import read_model_description
from tests.hostile.build import description

COUNTS = (2_000, 20_000)


def seconds(folder: Path, count: int, more: str) -> float:
    """CPU time of the quickest of three readings."""
    variables = "\n".join(
        f'<Float64 name="part[{i}].x" valueReference="{i + 10}" description="number {i}" '
        f'causality="output" initial="exact" start="{i}" {more}/>'
        for i in range(count)
    )
    outputs = "".join(f'<Output valueReference="{i + 10}"/>' for i in range(count))
    text = description(3).replace("</ModelVariables>", variables + "</ModelVariables>")
    text = text.replace("</ModelStructure>", outputs + "</ModelStructure>")
    (folder / "modelDescription.xml").write_text(text)
    times = []
    for _ in range(3):
        began = time.process_time()
        described, faults = read_model_description(folder, Path("large.fmu"))
        times.append(time.process_time() - began)
    assert len(described.variables) == count + 5 and len(faults) == (count if more else 0)
    return min(times)


@pytest.mark.slow  # a figure of time, which a loaded machine moves
@pytest.mark.parametrize("more", ["", 'strange="1"', 'unit="none"'])
def test_reading(tmp_path: Path, more: str) -> None:
    few, many = (seconds(tmp_path, count, more) for count in COUNTS)
    assert many < 20 * few
    assert many < 4.0
