"""Checkpoints: all that a run has to remember, from which it goes on bit by bit as it would have.

A checkpoint is taken between two cycles. It holds the loop's signals and the texts that they name,
the states of blocks and delays, the serialised states of FMUs, the number of the next cycle and the
number of rows before it. Signals and noise need nothing: their values depend on how many samples
came before, so they are drawn again up to there. What the run was made of goes in as hashes, and is
compared.

Files are written whole or not at all, and are read without running code in them. This module
refuses plain Python controllers, whose state it cannot know, FMUs that cannot serialise theirs, and
those of which the harness remembers more: its solver, or the events to come.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiler.step import step_fingerprint
from harness.errors import RecordingError
from harness.fmi.binding.interface import CO_SIMULATION
from harness.fmi.fmu import Fmu
from harness.master.plan.planner import Plan
from harness.master.program.link import Program
from harness.results.atomic import atomic_write, writing
from harness.results.manifest import COMPLETE, read_manifest, software_versions
from harness.results.storage import CSV_FILE, seal
from harness.system.graph import BlockComponent, Component, FmuComponent, PythonComponent
from harness.system.policy import capabilities_of, interface

CHECKPOINT_FILE = "checkpoint.npz"
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A run between two cycles: `cycle` is next, `rows` were recorded before it, `now_ns` was the
    last instant. `made_of` are hashes by the name of what was hashed."""

    cycle: int
    rows: int
    now_ns: int
    v: NDArray[np.float64]
    exchange: NDArray[np.uint8]
    texts: tuple[str | bytes, ...]
    blocks: Mapping[str, NDArray[np.float64]]
    fmus: Mapping[str, bytes]
    made_of: Mapping[str, str] = field(default_factory=dict)

    def to_bytes(self) -> bytes:
        """As an .npz archive without pickled objects."""
        head = {
            "cycle": self.cycle, "rows": self.rows, "now_ns": self.now_ns,
            "made_of": dict(self.made_of), "blocks": list(self.blocks), "fmus": list(self.fmus),
            "texts": [t if isinstance(t, str) else [t.hex()] for t in self.texts],
        }  # fmt: skip
        arrays: dict[str, NDArray[Any]] = {
            "head": np.frombuffer(json.dumps(head).encode(), dtype=np.uint8),
            "v": self.v, "exchange": self.exchange,
            **{f"block{i}": state for i, state in enumerate(self.blocks.values())},
            **{f"fmu{i}": np.frombuffer(s, np.uint8) for i, s in enumerate(self.fmus.values())},
        }  # fmt: skip
        file = io.BytesIO()
        np.savez(file, allow_pickle=False, **arrays)
        return file.getvalue()

    @classmethod
    def from_bytes(cls, content: bytes) -> Snapshot:
        """What `to_bytes` made; raises `RecordingError` where it is damaged."""
        try:
            with np.load(io.BytesIO(content), allow_pickle=False) as found:
                head = json.loads(found["head"].tobytes())
                head |= {
                    "v": found["v"], "exchange": found["exchange"],
                    "texts": tuple(
                        t if isinstance(t, str) else bytes.fromhex(t[0]) for t in head["texts"]
                    ),
                    "blocks": {n: found[f"block{i}"] for i, n in enumerate(head["blocks"])},
                    "fmus": {n: found[f"fmu{i}"].tobytes() for i, n in enumerate(head["fmus"])},
                }  # fmt: skip
                return cls(**head)
        except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as fault:
            raise RecordingError(f"the checkpoint is damaged: {fault!r}") from fault


def take(
    program: Program, cycle: int, rows: int, now_ns: int, made_of: Mapping[str, str]
) -> Snapshot:
    """The state of a run before `cycle`; raises `FmuError` where an FMU refuses."""
    memory = program.memory
    fmus = {name: fmu.instance.serialized_state() for name, fmu in program.fmus.items()}
    return Snapshot(
        cycle, rows, now_ns, program.v, memory.exchange, tuple(memory.texts.entries),
        _memories(program), fmus, made_of,
    )  # fmt: skip


def restore(program: Program, snapshot: Snapshot) -> None:
    """Bring an initialised run to where `snapshot` was taken."""
    for name, content in snapshot.fmus.items():
        program.fmus[name].instance.restore_state(content)
    program.v[:] = snapshot.v
    program.memory.exchange[:] = snapshot.exchange
    program.memory.texts.replace(snapshot.texts)
    memories = _memories(program)
    for name, state in snapshot.blocks.items():
        memories[name][:] = state


def _memories(program: Program) -> dict[str, NDArray[np.float64]]:
    """All arrays that compiled code keeps from one instant to another, by name."""
    iterations = enumerate(program.iterations.values())
    return {**program.states, **{f"iteration {i}": one.work for i, one in iterations}}


def why_not(plan: Plan, fmus: Mapping[str, Fmu]) -> str:
    """Why a run cannot have checkpoints, or nothing."""
    for c in plan.lowered.components:
        if isinstance(c, PythonComponent):
            return f"component {c.name} is plain Python, whose state cannot be saved"
    for c in plan.lowered.fmus:
        d = fmus[c.name].description
        kind, can = interface(c.policy.interface_type, d), capabilities_of(c.policy, d)
        if kind != CO_SIMULATION:
            return f"component {c.name} is run in {kind}, whose solver's memory cannot be saved"
        if can.has_event_mode and c.policy.event_mode is not False:
            return (
                f"component {c.name} is run with event mode, and its events to come cannot be "
                "saved (event_mode = false does without)"
            )
        if c.inputs is not None or c.policy.discarded_steps == "divide":
            return f"the steps of component {c.name} may be cut, and how far they are is not saved"
        if not can.can_serialize_fmu_state:
            return f"the FMU of component {c.name} cannot serialise its state"
    return ""


def made_of(plan: Plan, fmus: Mapping[str, Fmu]) -> dict[str, str]:
    """Hashes and versions of all that decides the bits of a run, by name."""
    lowered, system = plan.lowered, plan.lowered.system
    times = system.start_ns, system.stop_ns, plan.cycle_ns, system.record_ns
    parts = {f"component {c.name}": _content(c) for c in lowered.components} | {
        "times": (*times, system.ticks_per_second),
        "algorithm and seed": (system.algorithm, system.seed),
        "convergence": system.convergence,
        "connections": lowered.wires,
        "schedule": plan.instants,
        "recorded signals": plan.recorded,
    }
    with np.printoptions(override_repr=_all_of):
        found = {name: _hash(repr(part).encode()) for name, part in parts.items()}
    found |= {f"FMU of {name}": fmu.sha256 for name, fmu in fmus.items()}
    return found | {f"version of {name}": text for name, text in software_versions().items()}


def _content(component: Component) -> object:
    """What decides the bits of a component besides the FMU itself."""
    if isinstance(component, FmuComponent):
        return replace(component, path=Path())
    if isinstance(component, BlockComponent):
        block = component.block
        rate = component.name, component.period_ns, component.phase_ns
        return rate, step_fingerprint(block.step), block.parameters, block.state
    return _ADDRESS.sub("", repr(component))


def _all_of(array: NDArray[Any]) -> str:
    """An array in all of its bits, where numpy shows some."""
    content = repr(array.tolist()).encode() if array.dtype.hasobject else array.tobytes()
    return f"array({array.dtype}, {array.shape}, {_hash(content)})"


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def differences(before: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    """The names of what is not as it was."""
    names = sorted({*before, *now})
    return [name for name in names if before.get(name) != now.get(name)]


def write_checkpoint(folder: Path, content: bytes) -> None:
    """Put a checkpoint into the run folder in place of the one before it, whole or not at all."""
    with (
        writing(f"cannot write a checkpoint into {folder}"),
        atomic_write(folder / CHECKPOINT_FILE) as partial,
        partial.open("wb") as file,
    ):
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def resumable(folder: Path) -> Snapshot | None:
    """The last checkpoint of the run in `folder`, None where it has to begin anew.

    Raises `RecordingError` where there is no run, or it is complete, or cannot be continued; the
    rows of one that has no checkpoints are brought into their final form.
    """
    manifest, path = read_manifest(folder), folder / CHECKPOINT_FILE
    if manifest.status.state == COMPLETE:
        raise RecordingError(f"the run in {folder} is complete; there is nothing to resume")
    try:
        if path.exists():
            return Snapshot.from_bytes(path.read_bytes())
    except OSError as fault:
        raise RecordingError(f"{path} cannot be read: {fault}") from fault
    except RecordingError as fault:
        raise RecordingError(f"{folder}: {fault}; run it again into another folder") from fault
    if manifest.not_resumable:
        seal(folder)
        raise RecordingError(
            f"the run in {folder} cannot be resumed: {manifest.not_resumable}; its rows so far "
            f"are in {CSV_FILE}, run it again into another folder"
        )
    return None
