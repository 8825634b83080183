"""The FMU of a controller gives the bits that its step gives in the loop, sample for sample."""

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from harness import registry
from harness.export.controller import controller_fmu
from tests.harness.export.blocks import (
    EXAMPLES,
    LONG_TO_COMPILE,
    WITHOUT_EXAMPLE,
    InProcess,
    example,
    random_inputs,
)
from tests.harness.export.conftest import NewInstance

CASES = [
    pytest.param(name, marks=pytest.mark.slow if name in LONG_TO_COMPILE else ())
    for name in sorted(EXAMPLES)
]


def test_every_registered_controller_is_a_case() -> None:
    assert set(EXAMPLES) | WITHOUT_EXAMPLE == set(registry.names(registry.CONTROLLERS))


@pytest.mark.parametrize("name", CASES)
def test_bit_for_bit(name: str, version: int, new_instance: NewInstance) -> None:
    block, sample_time = example(name)
    path = controller_fmu(block, "block", sample_time, version)
    assert validate_fmu(str(path)) == []
    instance, loop = new_instance(block, version, sample_time), InProcess(block)
    inputs = [s.name for s in block.inputs]
    outputs = [s.name for s in block.outputs]
    for k, u in enumerate(random_inputs(block, 300)):
        instance.set(**dict(zip(inputs, u.tolist(), strict=True)))
        instance.step(k, sample_time)
        expected = loop(u)
        assert np.all(np.isfinite(expected))
        np.testing.assert_array_equal(instance.get(*outputs), expected, err_msg=f"sample {k}")
    names = [name for name in instance.references if name.startswith(("state.", "state["))]
    assert len(names) == len(block.state)
    np.testing.assert_array_equal(instance.get(*names), loop.x)
