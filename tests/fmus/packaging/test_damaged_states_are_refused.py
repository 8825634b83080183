"""No damaged bytes are taken for a serialised state, by whatever kind of FMU."""

from collections.abc import Iterator
from ctypes import byref, c_size_t, c_void_p, create_string_buffer
from pathlib import Path

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from fmus.packaging.plant.build import cached_fmu
from tests.fmus.packaging.calls import everything
from tests.fmus.packaging.raw import CO_SIMULATION, OK, Raw

KINDS = [(2, False), (3, False), (2, True), (3, True)]
IDS = ["FMI 2", "FMI 3", "portable FMI 2", "portable FMI 3"]
MANY = settings(
    max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
edits = st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), min_size=1)


@pytest.fixture(params=KINDS, ids=IDS)
def fmu(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Raw]:
    version, portable = request.param
    made = Raw(cached_fmu(everything, version, portable=portable), CO_SIMULATION, tmp_path)
    made.bring_to("step")
    yield made
    made.free()


def word(fmu: Raw) -> str:
    return "FMUState" if fmu.version == 3 else "FMUstate"


def serialised(fmu: Raw) -> bytes:
    state, size = c_void_p(), c_size_t()
    assert fmu.call(f"Get{word(fmu)}", byref(state)) == OK
    assert fmu.call(f"Serialized{word(fmu)}Size", state, byref(size)) == OK
    data = create_string_buffer(size.value)
    assert fmu.call(f"Serialize{word(fmu)}", state, data, size) == OK
    assert fmu.call(f"Free{word(fmu)}", byref(state)) == OK
    return data.raw


def taken(fmu: Raw, data: bytes) -> bool:
    """Whether the state in `data` was set; a portable FMU says it by its next step."""
    state, name = c_void_p(), "Deserialize" if fmu.version == 3 else "DeSerialize"
    if fmu.call(f"{name}{word(fmu)}", data, c_size_t(len(data)), byref(state)) != OK:
        return False
    assert fmu.call(f"Set{word(fmu)}", state) == OK
    assert fmu.call(f"Free{word(fmu)}", byref(state)) == OK
    return fmu.step(fmu.get("time"), 1e-3) == OK


@MANY
@given(edits)
def test_changed_bytes(fmu: Raw, edits: list[tuple[float, int]]) -> None:
    whole = serialised(fmu)
    changed = bytearray(whole)
    for place, change in edits:
        changed[int(place * len(whole))] ^= change
    assume(bytes(changed) != whole)
    assert not taken(fmu, bytes(changed))


@MANY
@given(st.binary(max_size=64), st.floats(0, 1, exclude_max=True))
def test_other_lengths(fmu: Raw, more: bytes, share: float) -> None:
    whole = serialised(fmu)
    assert not taken(fmu, whole[: int(share * len(whole))])
    assert not taken(fmu, more)
    assert not more or not taken(fmu, whole + more)


def test_the_whole_one_is_taken(fmu: Raw) -> None:
    assert fmu.set("input", 0.25) == OK
    data = serialised(fmu)
    assert fmu.set("input", 0.5) == OK
    assert taken(fmu, data)
    assert fmu.get("input") == 0.25
    assert fmu.get("time") == 1e-3
