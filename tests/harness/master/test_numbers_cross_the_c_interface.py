"""Float64 signals become C numbers and come back: exactly where they fit, refused where not."""

import ctypes

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.compiler import operations as op
from harness.master.program.exchange import decode, encode

DTYPES = {op.INT8: np.int8, op.UINT8: np.uint8, op.INT16: np.int16, op.UINT16: np.uint16,
          op.INT32: np.int32, op.UINT32: np.uint32, op.INT64: np.int64,
          op.UINT64: np.uint64}  # fmt: skip


def through(kind: int, *values: float) -> tuple[bytes, list[float]] | None:
    """The bytes of C numbers and what is read back, or None where they were refused."""
    v = np.array(values)
    room = np.full(8 + 8 * len(v), 0xAA, dtype=np.uint8)
    if not encode(kind, v, 0, len(v), room, 8):
        return None
    back = np.zeros(len(v))
    decode(kind, back, 0, len(v), room, 8)
    assert set(room[:8]) == {0xAA}
    return room[8 : 8 + op.ITEM_SIZE[kind] * len(v)].tobytes(), back.tolist()


@pytest.mark.parametrize("kind", DTYPES)
@settings(deadline=None, derandomize=True)
@given(data=st.data())
def test_integers_are_those_of_numpy(kind: int, data: st.DataObject) -> None:
    bounds = np.iinfo(DTYPES[kind])
    whole = st.integers(max(bounds.min, -(2**53)), min(bounds.max, 2**53)).map(float)
    values = data.draw(st.lists(whole, min_size=1, max_size=4))
    expected = np.array([int(x) for x in values], dtype=DTYPES[kind])
    assert through(kind, *values) == (expected.tobytes(), values)


@pytest.mark.parametrize("kind", DTYPES)
def test_what_does_not_fit_is_refused(kind: int) -> None:
    bounds = np.iinfo(DTYPES[kind])
    lowest, beyond = float(bounds.min), float(bounds.max) + (1.0 if bounds.bits < 64 else 0.0)
    highest = min(float(bounds.max), np.nextafter(beyond, 0.0))
    assert through(kind, lowest) is not None and through(kind, np.floor(highest)) is not None
    for value in (beyond, np.nextafter(lowest - 1.0, -np.inf), np.nan, np.inf, -np.inf):
        assert through(kind, value) is None, value
    assert through(kind, 1.0, beyond) is None


def test_halves_go_to_the_even_neighbour() -> None:
    found = through(op.INT32, 0.5, 1.5, 2.5, -0.5, -1.5)
    assert found is not None and found[1] == [0.0, 2.0, 2.0, 0.0, -2.0]


@pytest.mark.parametrize(("kind", "one"), [(op.BOOL8, b"\1"), (op.BOOL32, b"\1\0\0\0")])
def test_booleans_are_zero_or_one_whatever_the_number(kind: int, one: bytes) -> None:
    found = through(kind, 1.0, 0.25, -3.0, 0.0, 1e300)
    assert found == (one + one + one + bytes(len(one)) + one, [1.0, 1.0, 1.0, 0.0, 1.0])
    assert through(kind, np.nan) is None


@settings(deadline=None, derandomize=True)
@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_single_precision_passes_unchanged(value: float) -> None:
    assert through(op.FLOAT32, value) == (bytes(ctypes.c_float(value)), [value])


def test_single_precision_rounds_and_refuses_what_overflows() -> None:
    largest = float(np.finfo(np.float32).max)
    found = through(op.FLOAT32, 0.1, largest, -largest)
    assert found is not None and found[1] == [float(np.float32(0.1)), largest, -largest]
    for value in (2.0**128, -(2.0**128), np.nan, np.inf):
        assert through(op.FLOAT32, value) is None
