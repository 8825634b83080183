"""The parity certificate of a controller's FMU replayed by other tools, to the last bit.

All registered controllers: `python -m tests.peers.table`. Here are two that are quickly made.
"""

from __future__ import annotations

import pytest

from harness.export.controller import controller_fmu
from tests.harness.export.blocks import example
from tests.peers.replays import replayed
from tests.peers.tools import skip_without


@pytest.mark.parametrize("name", ["pid", "lq_regulator"])
@pytest.mark.parametrize("portable", [False, True], ids=["native", "portable"])
@pytest.mark.parametrize(
    ("tool", "version"), [("fmpy", 2), ("fmpy", 3), ("ecos", 2), ("ecos", 3), ("libcosim", 2)]
)
def test_to_the_last_bit(tool: str, version: int, portable: bool, name: str) -> None:
    skip_without(tool)
    block, sample_time = example(name)
    path = controller_fmu(block, name, sample_time, version, portable=portable)
    assert replayed(tool, path) == 0.0
