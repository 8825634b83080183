"""The FMUs of a system, opened, and what they say of themselves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager

from harness.fmi.description.model_description import ModelDescription
from harness.fmi.fmu import Fmu
from harness.fmi.start_values import configured
from harness.system.graph import FmuComponent, System
from harness.system.policy import capabilities_of


@contextmanager
def opened(system: System) -> Iterator[dict[str, Fmu]]:
    """The FMUs of a system by component name; each archive is unpacked once, or once for each
    component where its library may have one instance only."""
    with ExitStack() as stack:
        by_path: dict[str, Fmu] = {}
        found: dict[str, Fmu] = {}
        for component in system.fmus:
            key = str(component.path)
            known = by_path.get(key)
            if known is None or only_once(component, known.description):
                known = Fmu(component.path, validate=component.policy.validate)
                by_path[key] = stack.enter_context(known)
            found[component.name] = known
        yield found


def only_once(component: FmuComponent, d: ModelDescription) -> bool:
    """Whether a library of the component's FMU may have one instance in a process."""
    return capabilities_of(component.policy, d).can_be_instantiated_only_once


def descriptions_of(system: System, fmus: Mapping[str, Fmu]) -> dict[str, ModelDescription]:
    """What the FMUs say of themselves, arrays with the sizes that start values give them."""
    return {c.name: configured(fmus[c.name].description, c.start_values) for c in system.fmus}
