"""A controller or estimator as an FMU that needs no Python where it runs.

The FMU holds the step function of the loop as native code (`harness.execution.native`); who packs
it is found by the entry point `fmu_harness.packagers`. It computes sample k inside the step that
begins at t_k with the inputs set at t_k: see the FMU's description for what that means in a tool.

This module refuses blocks that are plain Python callables: they have no step function over arrays.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from harness import registry
from harness.clock import to_nanoseconds, to_period
from harness.errors import FmuError, HarnessError
from harness.execution.native import native_key, native_step
from harness.system.block import Block

ExtraFiles = Callable[[Path], Mapping[str, bytes]]


def controller_fmu(
    block: Block,
    name: str,
    sample_time: float,
    fmi_version: int = 3,
    *,
    phase: float = 0.0,
    description: str = "",
    targets: Sequence[str] = (),
    extra: ExtraFiles | None = None,
) -> Path:
    """The FMU of `block`, from the cache or built; `sample_time` and `phase` in seconds.

    `name` becomes the model's identifier, with underscores for what no identifier may hold.
    `targets` are the platforms of its binaries ("aarch64-linux", "win64", "all"), this one when
    none is named. `extra(path)` gets the finished FMU and returns files to add below `extra/`.
    Raises `CompileError` where the step cannot be native code, `FmuError` where no FMU can hold it.
    """
    period_ns = to_period(sample_time, f"sample time of {name}")
    phase_ns = to_nanoseconds(phase, f"phase of {name}")
    package = registry.packager("native")
    try:
        path: Path = package(
            partial(native_step, block),
            step_key=native_key(block),
            name=identifier(name),
            description=description or f"Controller {name}.",
            sample_time_ns=period_ns,
            phase_ns=phase_ns,
            inputs=block.inputs,
            outputs=block.outputs,
            parameters=block.parameters,
            state=block.state,
            parameter_names=getattr(block, "parameter_names", ()),
            state_names=getattr(block, "state_names", ()),
            tunable=getattr(block, "tunable", ()),
            fmi_version=fmi_version,
            targets=targets,
            extra=extra,
        )
    except HarnessError:
        raise
    except Exception as fault:  # a packager has errors of its own
        raise FmuError(f"controller {name} cannot be packaged as an FMU: {fault}") from fault
    return path


def identifier(name: str) -> str:
    """`name` as a C identifier."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    return plain if plain and not plain[0].isdigit() else f"_{plain}"
