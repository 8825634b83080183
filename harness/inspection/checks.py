"""The checks of co-simulation behaviour, each a function of a `Subject`.

An `FmuError` that a check does not catch itself is that check's failure; the caller sees to it.
"""

from __future__ import annotations

import gc
import hashlib
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import FmuError
from harness.fmi.instance import FmuInstance
from harness.inspection.finding import Finding, failed, not_offered, passed
from harness.inspection.subject import STEPS, Array, Subject, scale_of, within

CYCLES = 200
"""Instantiations of the leak check."""

_WARM_UP = 50  # cycles until the allocators have settled
_LEAK = 2048  # bytes a cycle that count as a leak; less drowns in the allocators' own growth
_RELATIVE = 1e-4  # agreement of derivatives with finite differences
_INCREMENT = 1e-6


def runs(subject: Subject) -> Finding:
    """Instantiates, initialises, steps, terminates."""
    with subject.running() as instance:
        rows = subject.advance(instance)
        instance.terminate()
    bad: NDArray[np.bool_] = np.atleast_1d(~np.isfinite(rows).all(axis=0))
    if bad.any():
        names = _names(subject, bad)
        return failed(f"values are not finite: {names}")
    return passed(f"{STEPS} steps of {subject.step:g} s")


def instantiates_twice(subject: Subject) -> Finding:
    """Two instances at once do not disturb each other."""
    capabilities = subject.description.co_simulation
    if capabilities is not None and capabilities.can_be_instantiated_only_once:
        return not_offered("canBeInstantiatedOnlyOncePerProcess is true")
    with subject.running("first") as first, subject.running("second") as second:
        expected = subject.advance(first)
        found = subject.advance(second)
    if _same(expected, found):
        return passed("the second runs as the first did")
    return failed(
        f"the second is disturbed by the first: {_difference(subject, expected, found)}",
        "canBeInstantiatedOnlyOncePerProcess is false",
    )


def repeats(subject: Subject) -> Finding:
    """Two runs, one after the other, agree bit for bit; their hash is for another process."""
    found = []
    for _ in range(2):
        with subject.running() as instance:
            found.append(subject.advance(instance))
    digest = hashlib.sha256(found[0].tobytes()).hexdigest()
    if _same(*found):
        return passed("bit for bit", digest=digest)
    return failed(f"two runs differ: {_difference(subject, *found)}", digest=digest)


def resets(subject: Subject) -> Finding:
    """After a reset the instance is a fresh one."""
    with subject.running() as instance:
        expected = subject.advance(instance)
        try:
            instance.reset()
        except FmuError as fault:
            return failed(str(fault))
        subject.initialise(instance)
        found = subject.advance(instance)
    if _same(expected, found):
        return passed("to a fresh state, bit for bit")
    return failed(f"something of the old run remains: {_difference(subject, expected, found)}")


def restores(subject: Subject) -> Finding:
    """A snapshot brings everything back."""
    flag = "canGetAndSetFMUState"
    capabilities = subject.description.co_simulation
    if capabilities is None or not capabilities.can_get_and_set_fmu_state:
        return not_offered(f"{flag} is false")
    half = STEPS // 2
    with subject.running() as instance:
        subject.advance(instance, half)
        try:
            state = instance.get_state()
            expected = subject.advance(instance, half, first=half)
            instance.set_state(state)
            found = subject.advance(instance, half, first=half)
            instance.set_state(state)
            again = subject.advance(instance, half, first=half)
            instance.free_state(state)
        except FmuError as fault:
            return failed(str(fault), flag)
    if _same(expected, found) and _same(expected, again):
        return passed("and goes on bit for bit, twice")
    return failed(f"the run goes on otherwise: {_difference(subject, expected, found)}", flag)


def frees(subject: Subject) -> Finding:
    """Many instances leave nothing behind."""

    def cycle(count: int) -> None:
        for _ in range(count):
            with subject.running() as instance:
                subject.advance(instance, 1)
                instance.terminate()
        gc.collect()

    cycle(_WARM_UP)
    memory, files = _memory(), _files()
    middle = (CYCLES - _WARM_UP) // 2
    cycle(middle)
    between = _memory()
    cycle(CYCLES - _WARM_UP - middle)
    growth = (_memory() - memory) / (CYCLES - _WARM_UP)
    opened = _files() - files
    steady = between > memory and _memory() > between
    figures = {"bytes_per_cycle": growth, "descriptors": opened}
    if opened > 0:
        return failed(f"{opened} files stay open", **figures)
    if steady and growth > _LEAK:
        return failed(f"leaks about {growth / 1024:.0f} KiB an instance", **figures)
    return passed(f"growth {max(0.0, growth) / 1024:.1f} KiB an instance", **figures)


def takes_other_steps(subject: Subject) -> Finding:
    """Steps of half and double size."""
    flag = "canHandleVariableCommunicationStepSize"
    capabilities = subject.description.co_simulation
    if capabilities is None or not capabilities.can_handle_variable_step:
        return not_offered(f"{flag} is false")
    sizes = {"half": (0.5, 2 * STEPS), "double": (2.0, STEPS // 2)}
    phrases = []
    for word, (factor, steps) in sizes.items():
        with subject.running() as instance:
            try:
                rows = subject.advance(instance, steps, step=factor * subject.step)
            except FmuError as fault:
                return failed(f"{word}: {fault}", flag)
        if not np.isfinite(rows).all():
            return failed(f"{word}: values are not finite", flag)
        phrases.append(word)
    return passed(" and ".join(phrases))


def feeds_through_as_declared(subject: Subject) -> Finding:
    """Outputs that jump with an input are those of the model structure."""
    if not subject.moved or not subject.real_outputs:
        return not_offered("no real inputs or no real outputs")
    observed: set[tuple[str, str]] = set()
    with subject.running() as instance:
        for steps in (0, 3, 5):
            if steps:
                subject.advance(instance, steps, first=0 if steps == 3 else 3)
            observed |= _jumps(subject, instance)
    declared = subject.description.feedthrough
    hidden = sorted(
        f"{output} on {name}"
        for output, name in observed
        if (said := declared.get(output)) is not None and name not in said
    )
    if hidden:
        shown = ", ".join(hidden[:5]) + (" …" if len(hidden) > 5 else "")
        return failed(f"undeclared: {shown}", f"dependencies of {hidden[0].split(' on ')[0]}")
    silent = sorted(output for output, said in declared.items() if said is None)
    note = f"; no statement for {len(silent)} outputs" if silent else ""
    return passed(f"{len(observed)} observed{note}", observed=sorted(map(list, observed)))


def differentiates(subject: Subject) -> Finding:
    """Directional derivatives of outputs by inputs agree with central differences."""
    flag = "providesDirectionalDerivatives"
    capabilities = subject.description.co_simulation
    if capabilities is None or not capabilities.provides_directional_derivatives:
        return not_offered(f"{flag} is false")
    outputs = [v.name for v in subject.real_outputs]
    if not outputs or not subject.moved:
        return not_offered("no real inputs or no real outputs")
    worst, where = 0.0, ""
    with subject.running() as instance:
        subject.advance(instance, 3)
        for variable in subject.moved:
            try:
                exact = instance.directional_derivative(outputs, variable.name)
            except FmuError as fault:
                return failed(str(fault), flag)
            numeric, rounding = _slopes(subject, instance, variable.name)
            allowed = _RELATIVE * np.maximum(np.abs(numeric), np.abs(exact)) + rounding
            excess = np.abs(exact - numeric) / np.maximum(allowed, np.finfo(float).tiny)
            if excess.max() > worst:
                worst = float(excess.max())
                where = f"{outputs[int(excess.argmax())]} by {variable.name}"
    if worst > 1.0:
        return failed(f"{where} disagrees with its finite difference", flag)
    return passed(f"{len(outputs)} outputs by {len(subject.moved)} inputs agree")


def _slopes(subject: Subject, instance: FmuInstance, name: str) -> tuple[Array, Array]:
    variable = subject.description.variable(name)
    centre = float(instance.get(name))
    increment = _INCREMENT * max(scale_of(variable), abs(centre))
    rows = []
    for value in (centre + increment, centre - increment):
        instance.set({name: value})
        rows.append(np.array([instance.get(v.name) for v in subject.real_outputs]))
    instance.set({name: centre})
    rounding = 8 * np.finfo(float).eps * np.maximum(*np.abs(rows)) / increment
    return (rows[0] - rows[1]) / (2 * increment), rounding


def _jumps(subject: Subject, instance: FmuInstance) -> set[tuple[str, str]]:
    found = set()
    for variable in subject.moved:
        before = [instance.get(v.name) for v in subject.real_outputs]
        value = float(instance.get(variable.name))
        other = within(variable, value + 0.1 * scale_of(variable))
        if other == value:
            other = within(variable, value - 0.1 * scale_of(variable))
        instance.set({variable.name: other})
        after = [instance.get(v.name) for v in subject.real_outputs]
        instance.set({variable.name: value})
        found |= {
            (output.name, variable.name)
            for output, a, b in zip(subject.real_outputs, before, after, strict=True)
            if a != b
        }
    return found


def _same(a: Array, b: Array) -> bool:
    return a.shape == b.shape and a.tobytes() == b.tobytes()


def _difference(subject: Subject, expected: Array, found: Array) -> str:
    if expected.shape != found.shape:
        return f"{len(found)} rows instead of {len(expected)}"
    unequal = (expected != found) & ~(np.isnan(expected) & np.isnan(found))
    row = int(np.argmax(unequal.any(axis=1)))
    column = int(np.argmax(unequal[row]))
    name = _names(subject, np.arange(unequal.shape[1]) == column)
    return (
        f"{name} is {found[row, column]:.17g} instead of {expected[row, column]:.17g} "
        f"after step {row + 1}"
    )


def _names(subject: Subject, chosen: NDArray[np.bool_]) -> str:
    names = [v.name for v in subject.watched for _ in range(v.size)]
    found = list(dict.fromkeys(n for n, c in zip(names, chosen, strict=True) if c))
    return ", ".join(found[:5]) + (" …" if len(found) > 5 else "")


def _memory() -> int:
    """Resident memory of this process (bytes), 0 where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError):
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


def _files() -> int:
    folder = Path("/proc/self/fd")
    return len(list(folder.iterdir())) if folder.is_dir() else 0


CHECKS: dict[str, Callable[[Subject], Finding]] = {
    "runs": runs,
    "instantiates twice": instantiates_twice,
    "repeats a run": repeats,
    "resets": resets,
    "restores a snapshot": restores,
    "takes other steps": takes_other_steps,
    "feedthrough as declared": feeds_through_as_declared,
    "derivatives": differentiates,
    f"survives {CYCLES} instances": frees,
}
"""By name, in the order of the page."""
