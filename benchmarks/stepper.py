"""Steps an FMU through the addresses of its functions and times every doStep.

Nothing of Python runs between two steps. The clock is read right before and after doStep; what
that costs (some 20 ns) is measured and taken off.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from harness.compiler.calls import call_status
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.fmu import Fmu

Array = NDArray[np.float64]
_MONOTONIC = 1
_ONE = np.int64(1)


@dataclass(frozen=True)
class Stepped:
    """Per step: nanoseconds (N,); states after it (N, n_x)."""

    nanoseconds: Array
    states: Array


@njit  # type: ignore[untyped-decorator]
def _run(
    three: bool, addresses: Any, c: int, h: float, inputs: Any, u: Any, x: Any,
    references: Any, flags: int, states: Any, times: Any, watch: Any,
) -> int:  # fmt: skip
    get, set_, do_step, clock = addresses[0], addresses[1], addresses[2], addresses[3]
    u_reference, x_reference, u_at, x_at, watch_at = (
        references[0], references[1], references[2], references[3], references[4],
    )  # fmt: skip
    n_u, n_x = u.shape[0], x.shape[0]
    for k in range(inputs.shape[0]):
        u[:] = inputs[k]
        if three:
            status = call_status(set_, (c, u_reference, n_u, u_at, n_u))
        else:
            status = call_status(set_, (c, u_reference, n_u, u_at))
        call_status(clock, (_ONE, watch_at))
        began = watch[0] * 1_000_000_000 + watch[1]
        if three:
            stepped = call_status(
                do_step, (c, k * h, h, _ONE, flags, flags + 1, flags + 2, flags + 8)
            )
        else:
            stepped = call_status(do_step, (c, k * h, h, _ONE))
        call_status(clock, (_ONE, watch_at))
        times[k] = watch[0] * 1_000_000_000 + watch[1] - began
        if three:
            got = call_status(get, (c, x_reference, n_x, x_at, n_x))
        else:
            got = call_status(get, (c, x_reference, n_x, x_at))
        if max(status, stepped, got) > 1:
            return k + 1
        states[k] = x
    return 0


@njit  # type: ignore[untyped-decorator]
def _clock_cost(clock: int, watch: Any, watch_at: int) -> int:
    least = 1_000_000
    for _ in range(1000):
        call_status(clock, (_ONE, watch_at))
        began = watch[1]
        call_status(clock, (_ONE, watch_at))
        if 0 <= watch[1] - began < least:
            least = watch[1] - began
    return least


def step_through(
    path: Path, tolerance: float, h: float, names: tuple[list[str], list[str]], inputs: Array,
    repeats: int,
) -> Stepped:  # fmt: skip
    """Steps of `h` seconds, inputs[k] held over step k; `names` are those of inputs and states.

    The run is repeated from a fresh instance; of each step the fastest repetition counts, since
    the work is the same each time and all else is the machine.
    """
    kept = np.full(len(inputs), np.inf)
    with Fmu(path) as fmu:
        for _ in range(repeats):
            with fmu.instantiate("plant") as instance:
                instance.enter_initialization_mode(0.0, len(inputs) * h, tolerance)
                instance.exit_initialization_mode()
                times, states = _drive(instance, h, names, inputs)
            kept = np.minimum(kept, times)
    return Stepped(kept, states)


def _drive(
    instance: FmuInstance, h: float, names: tuple[list[str], list[str]], inputs: Array
) -> tuple[Array, Array]:
    three = instance.prefix == "fmi3"
    real = "Float64" if three else "Real"
    clock = ctypes.cast(ctypes.CDLL(None).clock_gettime, ctypes.c_void_p).value or 0
    addresses = np.array(
        [*(instance.address(f) for f in (f"Get{real}", f"Set{real}", "DoStep")), clock]
    )
    u_references, x_references = (
        np.array([instance.description.variable(n).value_reference for n in group], np.uint32)
        for group in names
    )
    u, x = np.zeros(len(names[0])), np.zeros(len(names[1]))
    watch, flags = np.zeros(2, np.int64), np.zeros(16, np.uint8)
    pointers = np.array([a.ctypes.data for a in (u_references, x_references, u, x, watch)])
    times, states = np.zeros(len(inputs)), np.zeros((len(inputs), len(x)))
    cost = _clock_cost(clock, watch, watch.ctypes.data)
    failed = _run(
        three, addresses, instance.handle, h, inputs, u, x, pointers, flags.ctypes.data, states,
        times, watch,
    )  # fmt: skip
    if failed:
        raise SystemExit(f"{instance.description.name}: step {failed} failed")
    return times - cost, states
