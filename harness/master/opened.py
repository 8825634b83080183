"""The FMUs of a system, opened, and what they say of themselves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager

from harness.fmi.description.model_description import ModelDescription
from harness.fmi.fmu import Fmu
from harness.fmi.start_values import configured
from harness.system.graph import System


@contextmanager
def opened(system: System) -> Iterator[dict[str, Fmu]]:
    """The FMUs of a system by component name; each archive is unpacked once."""
    with ExitStack() as stack:
        by_path: dict[str, Fmu] = {}
        for component in system.fmus:
            key = str(component.path)
            if key not in by_path:
                by_path[key] = stack.enter_context(
                    Fmu(component.path, validate=component.policy.validate)
                )
        yield {c.name: by_path[str(c.path)] for c in system.fmus}


def descriptions_of(system: System, fmus: Mapping[str, Fmu]) -> dict[str, ModelDescription]:
    """What the FMUs say of themselves, arrays with the sizes that start values give them."""
    return {c.name: configured(fmus[c.name].description, c.start_values) for c in system.fmus}
