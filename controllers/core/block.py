"""The form of every discrete-time block: named signals, flat arrays and one step function.

A block is what the master loop calls at each sample instant. Its memory is four flat arrays of
float64, so that the same step function runs interpreted, compiled inside the loop, and (emitted
as native code) inside an FMU without Python.

The step function is `step(p, x, u, y)`:

    p  parameters, read only
    x  state, updated in place: x_k on entry, x_{k+1} on return
    u  inputs read at sample instant k
    y  outputs written for sample instant k

What it may not do, so that it can be emitted as native code: allocate arrays (work space belongs
to the state), raise, recurse, call anything but `math`, scalar numpy functions and other such
functions imported by name. Slices and `reshape` of its arguments are views and allowed. A block
that cannot go on writes NaN to its outputs; the master reports that with the time.

This module refuses to know how a block is scheduled, compiled or connected.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
StepFunction = Callable[[Array, Array, Array, Array], None]


@dataclass(frozen=True)
class Signal:
    """One named scalar at the border of a block.

    `unit` is an FMI-style unit string ("N", "m/s", "1"); `start` is the value that a reader sees
    before the block has run for the first time.
    """

    name: str
    unit: str = "1"
    description: str = ""
    start: float = 0.0


@dataclass(frozen=True, eq=False)
class Block:
    """A discrete-time block ready to run: signals, initial arrays and the step function.

    `parameters` has shape (n_p,), `state` (n_x,), in the order of `parameter_names` and
    `state_names`; the arrays are templates, which whoever runs the block copies. The first of
    `outputs` is the control or estimate itself, the others are internals offered as signals.
    `tunable` names the parameters that may be changed during a run in an exported FMU, because no
    other entry of `parameters` was calculated from them.
    """

    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    step: StepFunction
    parameters: Array = field(default_factory=lambda: np.zeros(0))
    parameter_names: tuple[str, ...] = ()
    state: Array = field(default_factory=lambda: np.zeros(0))
    state_names: tuple[str, ...] = ()
    tunable: tuple[str, ...] = ()
