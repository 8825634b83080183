"""Runs whose instants are all straight code, however short. Other runs of the tests are performed
row by row, since straight code does not pay for so few."""

from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch

from harness.master.program import straight


@contextmanager
def straight_code() -> Iterator[None]:
    with patch.multiple(straight, WORTH_MAKING=0, WORTH_LOADING=0):
        yield
        assert straight._specialiser() is not None
