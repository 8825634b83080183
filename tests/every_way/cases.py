"""What is run every way: an FMU, one kind of its interfaces, inputs, and what to compare."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.every_way.descriptions import Model
from tests.every_way.models import (
    BALL,
    CLOCKS,
    EVERY_TYPE,
    PARTITIONS,
    THERMOSTAT,
    fmu,
)
from tests.every_way.plain_events import SECOND, Job, Steps

STEP_NS = SECOND // 64
"""A power of two, so that no way of summing times rounds differently."""


@dataclass(frozen=True)
class Case:
    """One FMU, what is done to it, and what is watched."""

    name: str
    model: Model
    version: int
    kind: str
    watched: tuple[str, ...]
    inputs: dict[str, Steps] = field(default_factory=dict)
    start_values: dict[str, Any] = field(default_factory=dict)
    event_mode: bool | None = None
    triggers: dict[str, tuple[int, ...]] = field(default_factory=dict)
    path: Path | None = None
    step_ns: int = STEP_NS
    tolerance: float | None = None
    """For the solver, where the FMU does not say one."""
    accuracy: float = 1e-6
    """In model exchange, times the size of the value: what solvers at 1e-10, begun anew at events
    or at every row, and the bounces make of it."""

    @property
    def exact(self) -> bool:
        """Whether all ways give the same bits."""
        return self.kind != "model-exchange"

    def shape(self, name: str) -> tuple[int, ...]:
        """The dimensions of a watched variable."""
        v = next(v for v in self.model.variables if name in (v.name, *(a.name for a in v.aliases)))
        sizes = {v.name: v.start for v in self.model.variables} | self.start_values
        return tuple(int(sizes[d] if isinstance(d, str) else d) for d in v.dimensions)

    def job(self) -> Job:
        steps = round(self.model.stop * SECOND) // self.step_ns
        path = self.path or fmu(self.model, self.version, self.kind)
        return Job(
            path, self.kind, self.step_ns, steps, self.watched, self.inputs, self.start_values,
            bool(self.event_mode), self.triggers,
        )  # fmt: skip


def _watched(model: Model, version: int, *without: str) -> tuple[str, ...]:
    """Everything that can be read at any time: outputs and their other names."""
    old = ("Float64", "Int32", "Boolean", "String", "Enumeration")
    found = []
    for v in model.variables:
        if v.type == "Clock" or "clocks" in v.more or (version < 3 and v.type not in old):
            continue
        if version < 3 and v.dimensions:
            continue
        names = [v.name] * (v.causality == "output")
        names += [
            a.name for a in v.aliases
            if (v.causality if version == 3 else a.causality) == "output"
            and not (version > 1 and a.negated) and not (version == 3 and a.derivative_of)
        ]  # fmt: skip
        found += [name for name in names if name not in without]
    return tuple(found)


def _ways_of_running(version: int) -> list[tuple[str, bool | None]]:
    """Kinds of interfaces, and whether event mode is asked for, forbidden, or left to the way."""
    plain: list[tuple[str, bool | None]] = [("co-simulation", None), ("model-exchange", None)]
    modes = [("co-simulation", True), ("co-simulation", False)]
    return [*plain, *modes] if version == 3 else plain


def _case(
    title: str, model: Model, version: int, kind: str, event_mode: bool | None = None, *,
    without: tuple[str, ...] = (), only: tuple[str, ...] = (), **more: Any,
) -> Case:  # fmt: skip
    events = {None: "", True: "-events", False: "-no-events"}[event_mode]
    name = f"{title}-fmi{version}-{kind}{events}"
    watched = only or _watched(model, version, *without)
    return Case(name, model, version, kind, watched, event_mode=event_mode, **more)


def _half(value: Any, last: Any) -> Steps:
    return ((0, value), (SECOND // 2, last))


PUSHES = {"u": ((0, 0.0), (SECOND // 2, 2.0), (5 * SECOND // 4, -1.0))}
NUMBERS = {
    "Float64": (1.5, -2.25), "Float32": (0.5, 1024.125), "Int8": (-128, 127), "UInt8": (1, 255),
    "Int16": (-32768, 32767), "UInt16": (2, 65535), "Int32": (-(2**31), 2**31 - 1),
    "UInt32": (3, 2**32 - 1), "Boolean": (True, False), "Enumeration": (7, 1),
}  # fmt: skip
LONG = {"Int64": (-(2**63), 2**53 + 1), "UInt64": (2**64 - 1, 2**53 + 1)}
TEXTS = {"String": ("first", "second"), "Binary": (b"\x00\xff", b"")}


def _fed(values: dict[str, tuple[Any, Any]], version: int) -> dict[str, Any]:
    """Inputs of the types in `values`, and their echoes."""
    old = ("Float64", "Int32", "Boolean", "String", "Enumeration")
    types = [t for t in values if version == 3 or t in old]
    inputs = {f"{t}_in": _half(*values[t]) for t in types}
    watched = tuple(f"{t}_{end}" for t in types for end in ("out", "again"))
    return {"inputs": inputs, "only": watched}


def _all() -> list[Case]:
    found = []
    for version in (1, 2, 3):
        for kind, events in _ways_of_running(version):
            row = (version, kind, events)
            found += [
                _case("ball", BALL, *row, without=("rising",), start_values={"u": 1.0}),
                _case("pushed", BALL, *row, without=("a", "u_seen", "rising"), inputs=PUSHES),
                _case("thermostat", THERMOSTAT, *row),
            ]  # fmt: skip
        row = (version, "co-simulation")
        counts = ("steps", "steps_too", "odd", *(("third",) if version == 3 else ()))
        found += [
            _case("counts", EVERY_TYPE, *row, only=counts),
            _case("tolerance", EVERY_TYPE, *row, only=("tolerance",)),
            _case("numbers", EVERY_TYPE, *row, **_fed(NUMBERS, version)),
            _case("texts", EVERY_TYPE, *row, **_fed(TEXTS, version)),
            _case("labels", EVERY_TYPE, *row, only=("label", "label_too")),
        ]  # fmt: skip
    row = (3, "co-simulation")
    arrays, large = ("doubled", "table", "doubled_too"), ("large", "largest", "large_too")
    user = {"triggers": {"user": (SECOND // 4, SECOND)}}
    found += [
        _case("large", EVERY_TYPE, *row, only=large),
        _case("long", EVERY_TYPE, *row, **_fed(LONG, 3)),
        _case("bytes", EVERY_TYPE, *row, only=("bytes",)),
        _case("arrays", EVERY_TYPE, *row, only=arrays),
        _case("resized", EVERY_TYPE, *row, only=arrays,
              start_values={"n": 5, "w": [5.0, 4.0, 3.0, 2.0, 1.0]}),
        _case("partitions", PARTITIONS, 3, "scheduled-execution"),
    ]  # fmt: skip
    for kind, events in (("co-simulation", True), ("model-exchange", None)):
        found += [
            _case("clocks", CLOCKS, 3, kind, events),
            _case("triggered", CLOCKS, 3, kind, events, **user),
        ]
    for kind in BALL.kinds:
        found.append(_case("rising", BALL, 1, kind, only=("rising",)))
    return found


CASES = {case.name: case for case in _all()}
