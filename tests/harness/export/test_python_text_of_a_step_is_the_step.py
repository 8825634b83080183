"""The text that travels in a portable FMU computes the bits of the step that it was made from."""

from __future__ import annotations

import numpy as np
import pytest

from harness.compiler.source import python_source
from harness.compiler.step import CompileError
from harness.export.certify import growing
from tests.harness.export.blocks import EXAMPLES, example


@pytest.mark.parametrize("case", EXAMPLES)
def test_bit_for_bit(case: str) -> None:
    block = example(case)[0]
    scope: dict[str, object] = {}
    exec(python_source(block), scope)
    step = scope["step"]
    assert callable(step)
    inputs = np.array(list(growing([s.name for s in block.inputs]).values())).T
    memory = [(block.parameters.copy(), block.state.copy()) for _ in range(2)]
    with np.errstate(all="ignore"):
        for u in inputs:
            outputs = [np.zeros(len(block.outputs)) for _ in range(2)]
            block.step(*memory[0], u.copy(), outputs[0])
            step(*memory[1], u.copy(), outputs[1])
            assert outputs[0].tobytes() == outputs[1].tobytes()
            assert memory[0][1].tobytes() == memory[1][1].tobytes()


@pytest.mark.parametrize("case", EXAMPLES)
def test_it_needs_the_standard_library_and_numpy_only(case: str) -> None:
    lines = python_source(example(case)[0]).splitlines()
    imports = [line for line in lines if line.startswith(("import ", "from "))]
    assert imports == ["import math", "import numpy", "from numpy import array, float64"]


def test_what_cannot_be_written_is_named() -> None:
    class Odd:
        inputs = outputs = ()
        parameters = state = np.zeros(0)

        @staticmethod
        def step(p: object, x: object, u: object, y: object) -> None:
            print(EXAMPLES)

    with pytest.raises(CompileError, match=r"uses EXAMPLES, a dict, which cannot be written"):
        python_source(Odd())  # type: ignore[arg-type]


def test_a_step_without_source_is_refused() -> None:
    scope: dict[str, object] = {}
    exec("def step(p, x, u, y):\n    y[0] = u[0]\n", scope)

    class Typed:
        inputs = outputs = ()
        parameters = state = np.zeros(0)
        step = staticmethod(scope["step"])  # type: ignore[arg-type]

    with pytest.raises(CompileError, match="has no source to copy; write it in a file"):
        python_source(Typed())  # type: ignore[arg-type]
