"""The checks of a life: run, repeat, reset, take other steps, end. Each is a function of a
`Subject` of any kind.

A `HarnessError` that a check does not catch itself is that check's failure; the caller sees to it.
"""

from __future__ import annotations

import ctypes
import gc
import hashlib
import os
import time
from pathlib import Path

import numpy as np

from harness.errors import HarnessError
from harness.inspection.finding import Finding, claimed, failed, passed, require
from harness.inspection.rows import require_finite, require_same
from harness.inspection.subject import SLOW, Array, Subject
from harness.inspection.trial import Trial, running
from harness.process.fork import memory_of
from harness.results.comparison import first_difference

CYCLES = 200
"""Instantiations of the leak check."""

_LONG = 2.0  # seconds of a run beyond which it is cut short: there are some twenty of them
_WARM_UP = 50  # cycles until the allocators have settled
_COLLECTED = 25
_ROUNDS = 3  # Python takes memory by the megabyte, which fills once; a leak goes on
_LEAK = 2048  # bytes a cycle that count as a leak; less drowns in the allocators' own growth


def runs(subject: Subject) -> Finding:
    """Instantiates, initialises, steps, terminates."""
    with running(subject) as trial:
        first = trial.watch()
        rows = _timed(subject, trial)
        if not trial.ended:
            trial.instance.terminate()
    require_finite(subject, first, rows)
    if len(rows) < subject.steps:
        return passed(f"ends itself after {len(rows)} steps of {subject.step:g} s")
    why = ", no more since they take long" if subject.slow else ""
    return passed(f"{subject.steps} steps of {subject.step:g} s{why}")


def _timed(subject: Subject, trial: Trial) -> Array:
    """The rows of a run; where it takes long it is cut short, and so are those to come."""
    rows, began = [trial.advance(1)], time.monotonic()
    while len(rows) < subject.steps and not trial.ended:
        rows.append(trial.advance(1, first=len(rows)))
        if SLOW <= len(rows) < subject.steps and time.monotonic() - began > _LONG:
            subject.shorten(len(rows))
    return np.concatenate(rows)


def instantiates_twice(subject: Subject) -> Finding:
    """Two instances at once, stepped in turn, do not disturb each other."""
    once = subject.capabilities.can_be_instantiated_only_once
    require(not once, "canBeInstantiatedOnlyOncePerProcess is true")
    lie, half = "canBeInstantiatedOnlyOncePerProcess is false", subject.half
    alone = []
    for _ in range(2):
        with running(subject, "alone") as trial:
            alone.append(np.concatenate([trial.advance(half), trial.advance(half, half)]))
    with running(subject, "first") as first, running(subject, "second") as second:
        before = second.watch()
        parts = [(first.advance(half), second.watch(), second.advance(half))]
        if first_difference(subject.labels, before[None], parts[0][1][None]):
            return failed("an instance changes while another one steps", lie)
        parts.append((first.advance(half, half), before, second.advance(half, half)))
    if first_difference(subject.labels, *alone):
        return failed("cannot be judged, since one instance alone does not repeat its run")
    for word, index in (("first", 0), ("second", 2)):
        found = np.concatenate([part[index] for part in parts])
        require_same(subject, alone[0], found, f"the {word} of two is disturbed", lie)
    return passed("both run as one alone does")


def repeats(subject: Subject) -> Finding:
    """Two runs, one after the other, agree bit for bit; their hash is for another process."""
    runs = []
    for _ in range(2):
        with running(subject) as trial:
            runs.append(trial.advance())
    first, second = runs
    digest = hashlib.sha256(first.tobytes()).hexdigest()
    require_same(subject, first, second, "two runs differ", digest=digest)
    return passed("bit for bit", digest=digest)


def resets(subject: Subject) -> Finding:
    """After a reset the instance is a fresh one."""
    resettable = not subject.exchanges or subject.description.fmi_major > 1
    require(resettable, "FMI 1 has no reset in model exchange")
    with running(subject) as trial:
        expected = trial.advance()
        trial.instance.reset()
        trial.begin()
        found = trial.advance()
    require_same(subject, expected, found, "something of the old run remains")
    return passed("to a fresh state, bit for bit")


def takes_other_steps(subject: Subject) -> Finding:
    """Steps of half and double size."""
    flag = "canHandleVariableCommunicationStepSize"
    require(subject.capabilities.can_handle_variable_step, f"{flag} is false")
    sizes = {"half": (0.5, 2 * subject.steps), "double": (2.0, subject.half)}
    for word, (factor, steps) in sizes.items():
        with running(subject) as trial:
            first = trial.watch()
            try:
                rows = trial.advance(steps, factor=factor)
            except HarnessError as fault:
                return failed(f"{word}: {fault}", flag)
        require_finite(subject, first, rows, f"{word}: ", flag)
    return passed(" and ".join(sizes))


def interpolates_inputs(subject: Subject) -> Finding:
    """Takes the derivatives of its inputs, which linear wires give to those who ask for them."""
    flag = "canInterpolateInputs"
    major = subject.description.fmi_major
    offered = subject.capabilities.can_interpolate_inputs and major == 2
    require(offered, f"{flag} is false" if major < 3 else "not FMI 2")
    require(subject.real_inputs, "no real inputs")
    n = len(subject.real_inputs)
    references = (ctypes.c_uint32 * n)(*(v.value_reference for v in subject.real_inputs))
    arrays = references, (ctypes.c_int * n)(*n * [1]), (ctypes.c_double * n)()
    first, orders, slopes = (ctypes.pointer(one) for one in arrays)
    with running(subject) as trial, claimed(flag):
        trial.instance.call("SetRealInputDerivatives", first, ctypes.c_size_t(n), orders, slopes)
        trial.advance(1)
    return passed(f"of {n} inputs")


def frees(subject: Subject) -> Finding:
    """Many instances leave nothing behind."""

    def cycle(count: int) -> None:
        for number in range(count):
            with running(subject) as trial:
                trial.advance(0 if subject.slow else 1)
                if not trial.ended:
                    trial.instance.terminate()
            if number % _COLLECTED == 0:  # so that no part needs more room than the one before
                gc.collect()
        gc.collect()

    cycle(_WARM_UP)
    files, many = _files(), CYCLES - _WARM_UP
    for _ in range(_ROUNDS):
        held = [_held()]
        for part in (many // 2, many - many // 2):
            cycle(part)
            held.append(_held())
        growth = (held[2] - held[0]) / many
        if not (held[0] < held[1] < held[2] and growth > _LEAK):
            break
    else:
        return failed(f"leaks about {growth / 1024:.0f} KiB an instance", bytes_per_cycle=growth)
    opened = _files() - files
    figures = {"bytes_per_cycle": growth, "descriptors": opened}
    if opened > 0:
        return failed(f"{opened} files stay open", **figures)
    return passed(f"growth {max(0.0, growth) / 1024:.1f} KiB an instance", **figures)


def _held() -> int:
    """Bytes of memory that are this process's own, swapped out or not; what the system maps of
    files, such as code that runs for the first time, comes and goes as it likes."""
    try:
        lines = Path("/proc/self/smaps_rollup").read_text().splitlines()
    except OSError:
        return memory_of(os.getpid())
    found = (line.split() for line in lines if line.startswith(("Anonymous:", "Swap:")))
    return sum(1024 * int(size) for _, size, *_ in found)


def _files() -> int:
    folder = Path("/proc/self/fd")
    return len(list(folder.iterdir())) if folder.is_dir() else 0
