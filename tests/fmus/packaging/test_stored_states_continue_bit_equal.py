"""A stored state, as handle or as bytes, in the same or a new instance, continues bit by bit."""

import numpy as np
import pytest

from tests.fmus.packaging.conftest import NewInstance
from tests.fmus.packaging.plants import finite_escape, hydraulic

H = 0.01
NAMES = ["position", "velocity", "pressure_a", "pressure_b", "speed", "force", "der(velocity)"]


@pytest.fixture(params=["handle", "bytes", "bytes in a new instance"])
def way(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def test_continue(new_instance: NewInstance, version: int, way: str) -> None:
    """The state is taken at t = 0.1 s; the run goes on with another input and parameter."""
    instance = new_instance(hydraulic, version)
    instance.set(command=100.0, leakage=3e-12)
    instance.run(NAMES, 10, H)
    stored = instance.fmu.getFMUState()
    data = instance.fmu.serializeFMUState(stored)
    first = instance.run(NAMES, 20, H, first=10)
    instance.set(command=-50.0, leakage=0.0)
    instance.run(NAMES, 5, H, first=30)
    target = new_instance(hydraulic, version) if way.endswith("new instance") else instance
    if way != "handle":
        instance.fmu.freeFMUState(stored)
        stored = target.fmu.deserializeFMUState(data)
    target.fmu.setFMUState(stored)
    assert target.get("time", "command", "leakage") == [pytest.approx(0.1), 100.0, 3e-12]
    assert np.array_equal(target.run(NAMES, 20, H, first=10), first)
    target.fmu.freeFMUState(stored)


def test_equal_states_are_equal_bytes(new_instance: NewInstance, version: int) -> None:
    data = []
    for _ in range(2):
        instance = new_instance(hydraulic, version)
        instance.run(NAMES, 3, H)
        stored = instance.fmu.getFMUState()
        data.append(instance.fmu.serializeFMUState(stored))
        instance.fmu.freeFMUState(stored)
    assert data[0] == data[1]


def test_foreign_and_damaged_bytes_are_refused(new_instance: NewInstance, version: int) -> None:
    other = new_instance(finite_escape, version)
    stored = other.fmu.getFMUState()
    data = other.fmu.serializeFMUState(stored)
    other.fmu.freeFMUState(stored)
    instance = new_instance(hydraulic, version)
    stored = instance.fmu.getFMUState()
    own = instance.fmu.serializeFMUState(stored)
    instance.fmu.freeFMUState(stored)
    other_token = own[:12] + bytes([own[12] ^ 1]) + own[13:]
    for wrong in (data, b"", own[:-1], other_token):
        with pytest.raises(Exception, match="status 3"):
            instance.fmu.deserializeFMUState(wrong)
        assert "no state of this FMU" in instance.texts("logStatusError")[-1]
