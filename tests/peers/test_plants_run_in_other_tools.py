"""Our plants under other masters: the same numbers as in our loop, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.plant import Plant
from harness import registry
from harness.fmi.fmu import Fmu
from tests.fmus.conformance.excitation import Excited, excite
from tests.peers.order import Order, run_in
from tests.peers.tools import skip_without

CASES = [
    ("ecos", "FMI 2"),
    ("ecos", "FMI 3"),
    ("ecos", "portable"),
    ("libcosim", "FMI 2"),  # of FMI 3 libcosim says that the version is not supported
    ("libcosim", "portable"),
]


def steady_outputs(plant: Plant, fmu: str) -> list[str]:
    """States, and outputs that do not jump with an input."""
    with Fmu(fmu) as opened:
        feedthrough = opened.description.feedthrough
    states = [state.name for state in plant.states]
    return states + [name for name, inputs in feedthrough.items() if inputs == ()]


def order_of(plant: Plant, run: Excited, fmu: str) -> Order:
    held = run.inputs[:-1]
    inputs = {f"plant.{v.name}": held[:, i].tolist() for i, v in enumerate(plant.inputs)}
    outputs = [f"plant.{name}" for name in steady_outputs(plant, fmu)]
    return Order({"plant": fmu}, run.step, len(held), outputs, inputs)


@pytest.mark.parametrize("name", registry.names(registry.PLANTS))
@pytest.mark.parametrize(("tool", "kind"), CASES)
def test_to_the_last_bit(tool: str, kind: str, name: str) -> None:
    skip_without(tool)
    plant: Plant = registry.plant(name)
    portable = kind == "portable"
    version = 2 if portable else int(kind[-1])
    run = excite(plant, version)
    order = order_of(plant, run, str(plant.fmu(version, portable=portable)))
    found = run_in(tool, order)
    expected = np.array([run.result[output] for output in order.outputs]).T[1:]
    assert np.array_equal(found, expected)
