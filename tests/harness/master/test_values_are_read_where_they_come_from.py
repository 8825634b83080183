"""What has just been copied is read where it came from; where either end changes in between, or the
instant may leap, it is not."""

import numpy as np
import pytest

from harness.compiler import operations as op
from harness.master.program.shortcuts import shorten
from harness.participants.memory import Layout, Memory

N = 8


def shortened(*rows: list[int], copies: list[tuple[int, int]]) -> int:
    """The slot that the last row reads."""
    memory = Memory(Layout(), np.zeros(op.CLOCK_SIZE, dtype=np.int64), scratch=N)
    code = np.zeros((len(rows), op.WIDTH), dtype=np.int64)
    for i, row in enumerate(rows):
        code[i, : len(row)] = row
    places = {op.SET_FMI2: [5], op.BLOCK: [5, 6], op.GET_FMI2: [6]}
    for row in code:
        for column in places.get(int(row[0]), []):
            row[column] = memory.address(int(row[column]))
    shorten(memory, code, np.array([(s, t, 0) for s, t in copies]).reshape(-1, 3))
    return (int(code[-1, 5]) - memory.address(0)) // 8


COPY, SET = [op.COPY, 0, 1], [op.SET_FMI2, 9, 9, 9, 1, 5]
PAIR = [op.COPY, 0, 2], [op.SET_FMI2, 9, 9, 9, 2, 5]


def test_a_set_function_reads_the_source() -> None:
    assert shortened(COPY, [op.RECORD, 0, 0], SET, copies=[(2, 5)]) == 2


def test_a_block_does_so_too() -> None:
    block = [op.BLOCK, 9, 1, 9, 9, 5, 6, 9, 1]
    assert shortened(COPY, block, copies=[(2, 5)]) == 2


@pytest.mark.parametrize(("copies", "read"), [([(2, 5), (3, 6)], 2), ([(3, 5), (2, 6)], 5)])
def test_several_are_read_where_they_lie_in_the_same_order(
    copies: list[tuple[int, int]], read: int
) -> None:
    assert shortened(*PAIR, copies=copies) == read


@pytest.mark.parametrize(
    "between",
    [
        [op.GET_FMI2, 9, 1, 9, 9, 9, 2],
        [op.BLOCK, 9, 1, 9, 9, 7, 2, 9, 1],
        [op.CALL_4, 9, 0, 0, 0, 0],
        [op.SKIP, 9, 1],
    ],
)
def test_not_where_the_source_may_have_changed(between: list[int]) -> None:
    assert shortened(COPY, between, SET, copies=[(2, 5)]) == 5
