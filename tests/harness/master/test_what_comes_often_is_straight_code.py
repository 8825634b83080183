"""Instants that come often enough run as straight code, by themselves; damaged machine code counts
as not there."""

from pathlib import Path

import numpy as np
import pytest

from harness.compiler import operations as op
from harness.compiler.specialise import Operation, Specialiser, read, write
from harness.master.program import straight

ROWS = np.array([[op.CHECK, 0, 1, *[0] * 8], [op.RECORD, 0, 2, *[0] * 8]], dtype=np.int64)


def instants(times: int) -> np.ndarray:
    found = np.zeros((times, op.INSTANT_WIDTH), dtype=np.int64)
    found[:, 2] = len(ROWS)
    return found


def test_it_is_made_when_all_runs_together_are_worth_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(straight, "WORTH_MAKING", 100)
    monkeypatch.setattr(straight, "WORTH_LOADING", 10)
    monkeypatch.setattr(straight, "_performed", type(straight._performed)())
    made = []
    monkeypatch.setattr(Specialiser, "address", lambda self, ops, make: made.append(make) or 7)
    few, more = instants(2), instants(2)
    straight.lay_out(ROWS, few, 1)
    assert not made and not few[:, 3].any(), "4 operations are not worth the look"
    straight.lay_out(ROWS, few, 20)
    straight.lay_out(ROWS, more, 20)
    assert made == [False, True], "80 operations, and with those before them 160"
    assert (more[:, 3] == 7).all()


def test_programs_of_one_shape_share_their_code(tmp_path: Path) -> None:
    specialiser = straight._specialiser()
    assert specialiser is not None
    of = tuple(Operation(op.CHECK, n) for n in (1, 2))
    assert specialiser.address(of, make=True) == specialiser.address(of, make=False) != 0
    assert specialiser.address(of[::-1], make=True) != specialiser.address(of, make=False)


def test_damaged_code_counts_as_not_there(tmp_path: Path) -> None:
    path = tmp_path / "code.o"
    assert read(path) is None
    write(path, b"machine code")
    assert read(path) == b"machine code"
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    assert read(path) is None
