"""Checkpoints: all that a run has to remember, from which it goes on bit by bit as it would have.

A checkpoint is taken between two cycles. It holds the loop's signals, the states of blocks and
delays, the serialised states of FMUs, the number of the next cycle and the number of rows before
it. Signals and noise need nothing: their values depend on how many samples came before, so they
are drawn again up to there. What the run was made of goes in as hashes, and is compared.

Files are written whole or not at all, and are read without running code in them. This module
refuses plain Python controllers, whose state it cannot know, and FMUs that cannot serialise theirs.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiler.step import step_fingerprint
from harness.errors import RecordingError
from harness.master.plan.planner import Plan
from harness.master.program.link import Program
from harness.results.manifest import software_versions
from harness.system.graph import BlockComponent, Component, FmuComponent, PythonComponent

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
    blocks: Mapping[str, NDArray[np.float64]]
    fmus: Mapping[str, bytes]
    made_of: Mapping[str, str] = field(default_factory=dict)

    def to_bytes(self) -> bytes:
        """As an .npz archive without pickled objects."""
        numbers = {"cycle": self.cycle, "rows": self.rows, "now_ns": self.now_ns}
        head = json.dumps({**numbers, "made_of": dict(self.made_of)}).encode()
        arrays: dict[str, NDArray[Any]] = {
            "head": np.frombuffer(head, dtype=np.uint8), "v": self.v, "exchange": self.exchange,
            **_numbered("block", self.blocks),
            **_numbered("fmu", {n: np.frombuffer(b, np.uint8) for n, b in self.fmus.items()}),
        }  # fmt: skip
        names = json.dumps({"block": list(self.blocks), "fmu": list(self.fmus)}).encode()
        file = io.BytesIO()
        np.savez(file, allow_pickle=False, names=np.frombuffer(names, dtype=np.uint8), **arrays)
        return file.getvalue()

    @classmethod
    def from_bytes(cls, content: bytes) -> Snapshot:
        """What `to_bytes` made; raises `RecordingError` where it is damaged."""
        try:
            with np.load(io.BytesIO(content), allow_pickle=False) as held:
                head, names = (json.loads(held[key].tobytes()) for key in ("head", "names"))
                blocks = {n: held[f"block{i}"] for i, n in enumerate(names["block"])}
                fmus = {n: held[f"fmu{i}"].tobytes() for i, n in enumerate(names["fmu"])}
                return cls(v=held["v"], exchange=held["exchange"], blocks=blocks, fmus=fmus, **head)
        except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as fault:
            raise RecordingError(f"the checkpoint is damaged: {fault!r}") from fault


def _numbered(kind: str, arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    return {f"{kind}{i}": array for i, array in enumerate(arrays.values())}


def take(
    program: Program,
    cycle: int,
    rows: int,
    now_ns: int,
    made_of: Mapping[str, str],
) -> Snapshot:
    """The state of a run before `cycle`; raises `FmuError` where an FMU refuses."""
    fmus = {name: fmu.instance.serialized_state() for name, fmu in program.fmus.items()}
    arrays = program.v, program.memory.exchange, _memories(program)
    return Snapshot(cycle, rows, now_ns, *arrays, fmus, made_of)


def restore(program: Program, snapshot: Snapshot) -> None:
    """Bring an initialised run to where `snapshot` was taken."""
    for name, content in snapshot.fmus.items():
        program.fmus[name].instance.restore_state(content)
    program.v[:] = snapshot.v
    program.memory.exchange[:] = snapshot.exchange
    memories = _memories(program)
    for name, state in snapshot.blocks.items():
        memories[name][:] = state


def _memories(program: Program) -> dict[str, NDArray[np.float64]]:
    """All arrays that compiled code keeps from one instant to another, by name."""
    iterations = enumerate(program.iterations.values())
    return {**program.states, **{f"iteration {i}": one.work for i, one in iterations}}


def why_not(plan: Plan, instances_can: Mapping[str, bool]) -> str:
    """Why a run cannot have checkpoints, or nothing; `instances_can`: whether each FMU says that
    its state can be serialised."""
    for c in plan.lowered.components:
        if isinstance(c, PythonComponent):
            return f"component {c.name} is plain Python, whose state cannot be saved"
    for name, can in instances_can.items():
        if not can:
            return f"the FMU of component {name} cannot serialise its state"
    return ""


def made_of(plan: Plan, fmu_hashes: Mapping[str, str]) -> dict[str, str]:
    """Hashes and versions of all that decides the bits of a run, by name."""
    lowered, system = plan.lowered, plan.lowered.system
    found = {f"FMU of {name}": digest for name, digest in fmu_hashes.items()}
    found |= {f"component {c.name}": _hash(_content(c)) for c in lowered.components}
    span = (system.start_ns, system.stop_ns, plan.cycle_ns, system.record_ns)
    found["times"] = _hash(repr(span).encode())
    found["algorithm and seed"] = _hash(repr((system.algorithm, system.seed)).encode())
    found["convergence"] = _hash(repr(system.convergence).encode())
    found["connections"] = _hash(repr(lowered.wires).encode())
    found["schedule"] = _hash(repr(plan.instants).encode())
    found["recorded signals"] = _hash(repr(plan.recorded).encode())
    return found | {f"version of {name}": text for name, text in software_versions().items()}


def _content(component: Component) -> bytes:
    if isinstance(component, FmuComponent):
        kept = component.name, component.step_ns, component.start_values, component.policy
        return repr(kept).encode()
    if isinstance(component, BlockComponent):
        block = component.block
        rate = component.name, component.period_ns, component.phase_ns
        numbers = block.parameters.tobytes(), block.state.tobytes()
        return repr((rate, step_fingerprint(block.step), *numbers)).encode()
    return _ADDRESS.sub("", repr(component)).encode()


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def differences(before: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    """The names of what is not as it was."""
    names = sorted({*before, *now})
    return [name for name in names if before.get(name) != now.get(name)]


def write_checkpoint(folder: Path, content: bytes) -> None:
    """Put a checkpoint into the run folder in place of the one before it, whole or not at all."""
    path, partial = folder / CHECKPOINT_FILE, folder / (CHECKPOINT_FILE + ".partial")
    try:
        with partial.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except OSError as fault:
        partial.unlink(missing_ok=True)
        raise RecordingError(f"cannot write a checkpoint into {folder}: {fault}") from fault


def read_checkpoint(folder: Path) -> bytes | None:
    """The last checkpoint of a run folder, or None."""
    path = folder / CHECKPOINT_FILE
    try:
        return path.read_bytes() if path.exists() else None
    except OSError as fault:
        raise RecordingError(f"{path} cannot be read: {fault}") from fault
