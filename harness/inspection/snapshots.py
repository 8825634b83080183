"""The checks of an FMU's state: saved, restored, and carried into another process as bytes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.inspection.finding import Finding, claimed, passed, require
from harness.inspection.rows import require_same
from harness.inspection.subject import Subject
from harness.inspection.trial import Trial, running

_SNAPSHOT, _SERIAL = "canGetAndSetFMUState", "canSerializeFMUState"
_OTHERWISE = "the run goes on otherwise"


@contextmanager
def _halfway(subject: Subject) -> Iterator[Trial]:
    with running(subject) as trial:
        trial.advance(subject.half)
        require(not trial.ended, "the FMU ends the simulation before a snapshot could be taken")
        yield trial


def restores(subject: Subject) -> Finding:
    """A snapshot brings everything back."""
    require(subject.capabilities.can_get_and_set_fmu_state, f"{_SNAPSHOT} is false")
    with _halfway(subject) as trial, claimed(_SNAPSHOT):
        state, memory = trial.instance.get_state(), trial.memory()
        expected = trial.advance(subject.half, first=subject.half)
        repeated = []
        for _ in range(2):
            trial.instance.set_state(state)
            trial.recall(memory)
            repeated.append(trial.advance(subject.half, first=subject.half))
        trial.instance.free_state(state)
    for found in repeated:
        require_same(subject, expected, found, _OTHERWISE, _SNAPSHOT)
    return passed("and goes on bit for bit, twice")


def serialises(subject: Subject) -> Finding:
    """The state as bytes goes on in another instance; it is left for another process."""
    require(subject.capabilities.can_serialize_fmu_state, f"{_SERIAL} is false")
    with _halfway(subject) as trial:
        with claimed(_SERIAL):
            content = trial.instance.serialized_state()
        memory = json.dumps(trial.memory())
        expected = trial.advance(subject.half, first=subject.half)
    state = np.frombuffer(content, np.uint8)
    np.savez(left_behind(subject.scratch, subject.interface_type),
             state=state, memory=memory, rows=expected)  # fmt: skip
    if subject.capabilities.can_be_instantiated_only_once:
        return passed(f"{len(content)} bytes")
    another = f"{len(content)} bytes, another instance goes on bit for bit"
    return replace(continues(subject), detail=another)


def continues(subject: Subject) -> Finding:
    """What `serialises` has left, perhaps in another process, goes on bit for bit."""
    with np.load(left_behind(subject.scratch, subject.interface_type)) as left:
        state, memory, expected = left["state"].tobytes(), str(left["memory"]), left["rows"]
    with running(subject) as trial, claimed(_SERIAL):
        trial.instance.restore_state(state)
        trial.recall(json.loads(memory))
        found = trial.advance(subject.half, first=subject.half)
    require_same(subject, expected, found, _OTHERWISE, _SERIAL)
    return passed("the serialised state goes on bit for bit")


def left_behind(scratch: Path, interface_type: str) -> Path:
    """The file with the serialised state to go on from, and the rows that follow."""
    return scratch / f"{interface_type}.npz"
