"""A controller or estimator as an FMU that needs no Python where it runs.

The FMU holds the step function of the loop as native code (`harness.compiler.native`); who packs
it is found by the entry point `fmu_harness.packagers`. It computes sample k inside the step that
begins at t_k with the inputs set at t_k: see the FMU's description for what that means in a tool.

This module refuses blocks that are plain Python callables: they have no step function over arrays.
"""

from __future__ import annotations

import hashlib
import inspect
import re
import sys
from collections.abc import Sequence
from pathlib import Path

from harness import registry
from harness.clock import to_nanoseconds, to_period
from harness.compiler.native import native_key, native_step
from harness.compiler.source import python_source
from harness.errors import FmuError, HarnessError
from harness.export.certificate import MEMBER
from harness.export.certify import block_certificate
from harness.system.block import Block


def controller_fmu(
    block: Block,
    name: str,
    sample_time: float,
    fmi_version: int = 3,
    *,
    phase: float = 0.0,
    description: str = "",
    targets: Sequence[str] = (),
    portable: bool = False,
    certified: bool = True,
) -> Path:
    """The FMU of `block`, from the cache or built; `sample_time` and `phase` in seconds.

    `name` becomes the model's identifier, with underscores for what no identifier may hold.
    `targets` are the platforms of its binaries ("aarch64-linux", "win64", "all"), this one when
    none is named. `portable` asks for the Python packaging, which needs numpy there.
    The FMU carries a parity certificate unless it is not to be `certified`.
    Raises `CompileError` where the step cannot be native code, `FmuError` where it cannot be
    packed.
    """
    period_ns = to_period(sample_time, f"sample time of {name}")
    phase_ns = to_nanoseconds(phase, f"phase of {name}")
    if portable:
        text = python_source(block)
        key = f"python-{hashlib.sha256(text.encode()).hexdigest()}"
    else:
        key = native_key(block)

    def step() -> str:
        """The Python text of the step, or its LLVM module."""
        return text if portable else native_step(block)

    def certificate(path: Path) -> dict[str, bytes]:
        made = block_certificate(path, block, sample_time)
        return {MEMBER.removeprefix("extra/"): made.as_bytes()}

    try:
        path: Path = registry.packager("native")(
            step,
            step_key=key,
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
            extra=certificate if certified else None,
            portable=portable,
            equations=_equations(block),
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


def _equations(block: Block) -> str:
    """What the module of the step says about it, "" where there is no such text."""
    module = sys.modules.get(getattr(block.step, "__module__", ""))
    return inspect.getdoc(module) or ""
