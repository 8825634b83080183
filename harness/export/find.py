"""Which block is meant: a controller by name with its parameters, or one of an experiment.

Both go through the bench, so that what is exported is what would run, down to the error messages.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from harness import registry
from harness.bench import Bench
from harness.clock import to_period, to_seconds
from harness.errors import UsageError, nearest
from harness.experiment.experiment import Experiment
from harness.instruments.checks import lacking
from harness.system.block import Block
from harness.system.graph import BlockComponent, Component, PythonComponent


@dataclass(frozen=True, eq=False)
class FoundBlock:
    """A block to export: times in seconds, `description` says where it comes from."""

    name: str
    block: Block
    sample_time: float
    phase: float
    description: str


def named_controller(
    source: str, sample_time: float | None, parameters: Mapping[str, Any], name: str | None = None
) -> FoundBlock:
    """The controller registered as `source`, or that of "package.module:Class".

    `name` is that of its FMU; absent, the registered name or the class in lower case. Raises
    `UsageError` or what the controller has against its parameters.
    """
    if sample_time is None:
        raise UsageError(
            f"controller {source} needs its sample time in seconds, as in --sample-time 0.01"
        )
    to_period(sample_time, f"sample time of {source}")
    _require_parameters(source, registry.controller(source), parameters)
    chosen = name or source.rpartition(":")[2].lower()
    bench = Bench(stop_time=sample_time, step=sample_time)
    bench.controller(chosen, source, **parameters)
    (component,) = bench.system().components
    return _found(component, f"{_kind(bench, chosen)} with a sample time of {sample_time:g} s.")


def controllers_of(
    experiment: str,
    variant: str | None,
    components: Sequence[str],
    settings: Mapping[str, Any],
) -> list[FoundBlock]:
    """The controllers of an experiment as a variant of it (the first when None) configures them;
    all that run as blocks, or the `components` that are named."""
    loaded = Experiment.load(registry.experiment(experiment), settings)
    chosen = variant or loaded.variants[0]
    bench = loaded.bench(chosen)
    legal = {c.name: c for c in bench.system().components if c.name in bench.controllers}
    for name in components:
        if name not in legal:
            raise UsageError(
                f"{loaded.name} ({chosen}) has no controller {name!r}; {nearest(name, legal)}"
            )
    blocks = [name for name, c in legal.items() if isinstance(c, BlockComponent)]
    if not blocks and not components:
        raise UsageError(f"{loaded.name} ({chosen}) has no controllers that could be exported")
    return [
        _found(legal[name], f"{_kind(bench, name)}, {name} of {loaded.name} ({chosen}).")
        for name in components or blocks
    ]


def _require_parameters(source: str, kind: Any, parameters: Mapping[str, Any]) -> None:
    """Name what has no default and was not given, and how to give it."""
    if not (isinstance(kind, type) and dataclasses.is_dataclass(kind)):
        return
    absent = lacking(kind, parameters)
    if absent and set(parameters) <= {field.name for field in dataclasses.fields(kind)}:
        raise UsageError(
            f"controller {source} needs {', '.join(absent)}, as in --set {absent[0]}=VALUE; or "
            "take one of an experiment: --experiment NAME --component NAME"
        )


def _kind(bench: Bench, name: str) -> str:
    controller = bench.controllers[name]
    return (controller if isinstance(controller, type) else type(controller)).__name__


def _found(component: Component, description: str) -> FoundBlock:
    if isinstance(component, PythonComponent):
        raise UsageError(
            f"controller {component.name} is plain Python, called with (time, *inputs); an FMU "
            "without Python is made from a block: give it a method block(sample_time) that returns "
            "signals, arrays and a function step(p, x, u, y)"
        )
    assert isinstance(component, BlockComponent), "a controller is a block or plain Python"
    return FoundBlock(
        component.name,
        component.block,
        to_seconds(component.period_ns),
        to_seconds(component.phase_ns),
        description,
    )
