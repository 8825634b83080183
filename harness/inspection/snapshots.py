"""The checks of an FMU's state: saved, restored, and carried into another process as bytes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from harness.errors import HarnessError
from harness.inspection.finding import Finding, failed, not_offered, passed
from harness.inspection.subject import Subject
from harness.results.comparison import first_difference

_SNAPSHOT, _SERIAL = "canGetAndSetFMUState", "canSerializeFMUState"
_TOO_SHORT = "the FMU ends the simulation before a snapshot could be taken"


def restores(subject: Subject) -> Finding:
    """A snapshot brings everything back."""
    if not subject.capabilities.can_get_and_set_fmu_state:
        return not_offered(f"{_SNAPSHOT} is false")
    with subject.running() as trial:
        trial.advance(subject.half)
        if trial.ended:
            return not_offered(_TOO_SHORT)
        instance = trial.instance
        try:
            state, memory = instance.get_state(), trial.memory()
            expected = trial.advance(subject.half, first=subject.half)
            repeated = []
            for _ in range(2):
                instance.set_state(state)
                trial.recall(memory)
                repeated.append(trial.advance(subject.half, first=subject.half))
            instance.free_state(state)
        except HarnessError as fault:
            return failed(str(fault), _SNAPSHOT)
    for found in repeated:
        what = first_difference(subject.labels, expected, found)
        if what:
            return failed(f"the run goes on otherwise: {what}", _SNAPSHOT)
    return passed("and goes on bit for bit, twice")


def serialises(subject: Subject) -> Finding:
    """The state as bytes goes on in another instance; it is left for another process."""
    if not subject.capabilities.can_serialize_fmu_state:
        return not_offered(f"{_SERIAL} is false")
    with subject.running() as trial:
        trial.advance(subject.half)
        if trial.ended:
            return not_offered(_TOO_SHORT)
        try:
            content = trial.instance.serialized_state()
        except HarnessError as fault:
            return failed(str(fault), _SERIAL)
        memory = trial.memory()
        expected = trial.advance(subject.half, first=subject.half)
    bytes_file, rows_file, memory_file = _files(subject)
    bytes_file.write_bytes(content)
    np.save(rows_file, expected)
    memory_file.write_text(json.dumps(memory), encoding="utf-8")
    finding = _continues(subject, f"{len(content)} bytes, another instance goes on bit for bit")
    if subject.capabilities.can_be_instantiated_only_once:
        return passed(f"{len(content)} bytes")
    return finding


def continues(subject: Subject) -> Finding:
    """What `serialises` has left, perhaps in another process, goes on bit for bit."""
    return _continues(subject, "the serialised state goes on bit for bit")


def _continues(subject: Subject, words: str) -> Finding:
    bytes_file, rows_file, memory_file = _files(subject)
    expected = np.load(rows_file)
    with subject.running() as trial:
        try:
            trial.instance.restore_state(bytes_file.read_bytes())
            trial.recall(json.loads(memory_file.read_text(encoding="utf-8")))
            found = trial.advance(subject.half, first=subject.half)
        except HarnessError as fault:
            return failed(str(fault), _SERIAL)
    what = first_difference(subject.labels, expected, found)
    if what:
        return failed(f"the run goes on otherwise: {what}", _SERIAL)
    return passed(words)


def left_behind(subject_scratch: Path, interface_type: str) -> bool:
    """Whether there is a serialised state to go on from."""
    return all(path.exists() for path in _paths(subject_scratch, interface_type))


def _files(subject: Subject) -> tuple[Path, Path, Path]:
    return _paths(subject.scratch, subject.interface_type)


def _paths(scratch: Path, interface_type: str) -> tuple[Path, Path, Path]:
    stem = scratch / interface_type
    return (
        stem.with_suffix(".state"), stem.with_suffix(".npy"), stem.with_suffix(".json"),
    )  # fmt: skip
