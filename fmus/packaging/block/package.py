"""The FMU of a block as whoever compiles its step has it: signals, arrays, names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

from fmus.packaging.block.build import cached_block_fmu
from fmus.packaging.block.extra import ExtraFiles
from fmus.packaging.block.interface import BlockModel, BlockVariable, numbered
from fmus.packaging.block.portable import cached_portable_block
from fmus.packaging.cache import kept, write_atomically


class Signal(Protocol):
    """An input or output as controllers describe it."""

    @property
    def name(self) -> str:
        """Unique in the block."""

    @property
    def unit(self) -> str:
        """Such as "N"; "" where it is not stated."""

    @property
    def description(self) -> str:
        """One line for people."""

    @property
    def start(self) -> float:
        """The value before the block has run for the first time."""


def package_block(
    step: Callable[[], str],
    *,
    step_key: str,
    name: str,
    description: str,
    sample_time_ns: int,
    inputs: Sequence[Signal],
    outputs: Sequence[Signal],
    parameters: Sequence[float],
    state: Sequence[float],
    parameter_names: Sequence[str] = (),
    state_names: Sequence[str] = (),
    tunable: Sequence[str] = (),
    phase_ns: int = 0,
    fmi_version: int = 3,
    targets: Sequence[str] = (),
    extra: ExtraFiles | None = None,
    portable: bool = False,
    equations: str = "",
) -> Path:
    """`cached_block_fmu` for a block as whoever compiles its `step` has it: signals with name,
    unit, description and start, values as arrays, names where there are any. `step()` gives the
    LLVM module and is called unless it is known under `step_key`, which must change with it. Where
    the FMU is to be `portable`, it gives Python text, and the FMU is for every platform. This is
    what the entry-point group `fmu_harness.packagers` offers as "native"."""
    p_names = numbered("parameters", parameter_names, len(parameters))
    x_names = numbered("state", state_names, len(state))
    can_tune = [name in tunable for name in parameter_names] or [False] * len(parameters)
    model = BlockModel(
        name,
        description,
        sample_time_ns,
        tuple(BlockVariable(s.name, s.start, s.unit, s.description) for s in inputs),
        tuple(BlockVariable(s.name, s.start, s.unit, s.description) for s in outputs),
        tuple(
            BlockVariable(n, float(value), tunable=free)
            for n, value, free in zip(p_names, parameters, can_tune, strict=True)
        ),
        tuple(BlockVariable(n, float(value)) for n, value in zip(x_names, state, strict=True)),
        _known_step(step, step_key),
        phase_ns,
        equations=equations,
    )
    if portable:
        return cached_portable_block(model, fmi_version, extra)
    return cached_block_fmu(model, fmi_version, targets=targets, extra=extra)


def _known_step(step: Callable[[], str], key: str) -> str:
    """The module from the cache; making it can take seconds."""
    path = kept(f"steps/{key}.txt")
    if not path.exists():
        text = step()
        write_atomically(path, lambda part: part.write_bytes(text.encode()))
    return path.read_bytes().decode()
