"""What takes time, foremost machine code, made ready before a worker is forked, so that every
worker finds it there.

A worker's memory is gone with it, so what it loads it would load for every run. Nothing of an FMU
is touched here.
"""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from importlib import import_module

import numpy as np

from harness.clock import to_seconds
from harness.compiler import operations as op
from harness.compiler.step import compile_step
from harness.errors import HarnessError
from harness.fmi.binding.interface import MODEL_EXCHANGE
from harness.master.program.frame import Frame
from harness.participants.kinds import load_kernels
from harness.results.manifest import software_versions
from harness.system.graph import BlockComponent, System


def warm_up(system: System) -> None:
    """Load the loop and the blocks of `system`; a fault in a block is left for its run to tell."""
    load_loop()
    kinds = {c.policy.interface_type for c in system.fmus}
    load_kernels(exchange=MODEL_EXCHANGE in kinds)
    software_versions()
    blocks = [c.block for c in system.components if isinstance(c, BlockComponent)]
    with suppress(HarnessError):
        for connection in system.connections:
            period = to_seconds(system.record_ns)
            blocks += [one.block(period) for one in connection.imperfections]
        for block in blocks:
            compile_step(block)


def load_for_runs() -> None:
    """Load what any run uses and records with, before processes are forked that would each do."""
    import_module("harness.process.run")
    import_module("pyarrow.parquet")
    software_versions()
    load_loop()


@cache
def load_loop() -> None:
    """Load the loop, by a call that has nothing to do."""
    none, whole, real = np.zeros(0, dtype=np.int64), np.zeros(1, dtype=np.int64), np.zeros(1)
    clock, octets = np.zeros(op.CLOCK_SIZE, dtype=np.int64), np.zeros(8, dtype=np.uint8)
    Frame(
        none, none, clock, real, none, real, real, whole, octets, none, real, real, 0, 0, 1, 1, 0
    ).run()
