"""`fmu-harness info`: what an FMU says of itself, for people and as JSON."""

from __future__ import annotations

import dataclasses
import json
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.cli.options import AsJson, Compile, FmuFile, Validate
from harness.cli.tables import show_table
from harness.cli.terminal import properties
from harness.errors import UsageError

if TYPE_CHECKING:
    from rich.table import Table

    from harness.fmi.description.model_description import (
        Capabilities,
        LayeredStandard,
        ModelDescription,
        Terminal,
        Variable,
    )

_LIBRARIES = {".so", ".dll", ".dylib"}


def info_command(
    fmu: FmuFile, as_json: AsJson = False, validate: Validate = True, compile_: Compile = False
) -> None:
    """Show identity, capabilities and variables of an FMU."""
    from harness.fmi.fmu import Fmu

    if not fmu.exists() and fmu.suffix != ".fmu":
        from harness.experiment.catalogue import hint

        if said := hint(str(fmu)):
            raise UsageError(f"FMU {fmu} is not a file; {said}")
    if compile_:
        from harness.fmi.sources import compiled

        fmu = compiled(fmu, validate=validate)
    with Fmu(fmu, validate=validate) as opened:
        description, sha256 = opened.description, opened.sha256
        platforms = _platforms(opened.folder)
        for note in opened.notes:
            warnings.warn(note, stacklevel=1)
    if as_json:
        data = {f.name: getattr(description, f.name) for f in dataclasses.fields(description)}
        data["variables"] = list(description.variables.values())
        origin = {"sha256": sha256, "platforms": platforms, "notes": opened.notes}
        print(_as_json(origin | data))
        return
    show_table(_identity(description, sha256, platforms))
    for rows in (_clocks(description), _terminals(description), _variables(description)):
        _show(rows)


def _show(rows: Sequence[Sequence[str]]) -> None:
    """Print rows below their titles, if there are any, in columns that begin together."""
    if len(rows) < 2:
        return
    columns = [_of_one_width(cells) for cells in zip(*rows, strict=True)]
    print("\n".join("  ".join(row).rstrip() for row in zip(*columns, strict=True)))


def _of_one_width(cells: Sequence[str]) -> list[str]:
    """Cells of one line each, filled up to the widest."""
    from rich.cells import cell_len

    lines = [cell if cell.isprintable() else " ".join(cell.splitlines()) for cell in cells]
    widths = [len(line) if line.isascii() else cell_len(line) for line in lines]
    widest = max(widths)
    return [line + " " * (widest - width) for line, width in zip(lines, widths, strict=True)]


def _platforms(folder: Path) -> tuple[str, ...]:
    """The folders of `binaries` that hold a library, and "source code" where there is some."""
    binaries = (p for p in folder.glob("binaries/*/*") if p.suffix in _LIBRARIES)
    names = sorted({path.parent.name for path in binaries})
    return (*names, *(["source code"] if (folder / "sources").is_dir() else []))


def _as_json(data: dict[str, Any]) -> str:
    """A line for each key, since an indented document of thousands of variables takes seconds."""
    lines = (
        f"{json.dumps(key)}: {json.dumps(value, default=vars, ensure_ascii=False)}"
        for key, value in data.items()
    )
    return "{" + ",\n".join(lines) + "}"


def _identity(d: ModelDescription, sha256: str, platforms: tuple[str, ...]) -> Table:
    kinds = {
        "co-simulation": d.co_simulation,
        "model exchange": d.model_exchange,
        "scheduled execution": d.scheduled_execution,
    }
    defaults = {"start": d.start_time, "stop": d.stop_time, "step": d.step_size}
    shown = ", ".join(f"{k} {v:g} s" for k, v in defaults.items() if v is not None)
    events = d.number_of_event_indicators or len(d.event_indicators)
    rows = [
        ("description", d.description),
        ("FMI version", d.fmi_version),
        ("tool", d.generation_tool),
        ("token", d.token),
        ("sha256", sha256),
        ("platforms", ", ".join(platforms) or "none"),
        *((kind, _capabilities(c, kind == "co-simulation")) for kind, c in kinds.items()),
        *(("layered standard", _standard(one)) for one in d.layered_standards),
        ("default experiment", shown or "none"),
        ("states", _state_names(d)),
    ]
    if d.model_exchange is not None:
        rows.append(("event indicators", str(events)))
    return properties(d.name, rows)


def _standard(s: LayeredStandard) -> str:
    return f"{s.name} {s.version}" + f" ({s.description})" * bool(s.description)


def _state_names(d: ModelDescription) -> str:
    names = ", ".join(name for name, _ in d.states)
    unnamed = f"{d.number_of_continuous_states}, not named" * (d.number_of_continuous_states > 0)
    return names or unnamed or "none"


def _capabilities(c: Capabilities | None, stepping: bool) -> str:
    if c is None:
        return "no"
    flags = {
        "get and set state": c.can_get_and_set_fmu_state,
        "serialise state": c.can_serialize_fmu_state,
        "directional derivatives": c.provides_directional_derivatives,
        "adjoint derivatives": c.provides_adjoint_derivatives,
        "variable step": stepping and c.can_handle_variable_step,
        "event mode": c.has_event_mode,
        "early return": c.might_return_early,
        "intermediate update": c.provides_intermediate_update,
        "interpolates inputs": c.can_interpolate_inputs,
        "one instance a process": c.can_be_instantiated_only_once,
        "needs its tool installed": c.needs_execution_tool,
        f"fixed internal step {c.fixed_internal_step_size or 0:g} s": c.fixed_internal_step_size,
    }
    return ", ".join(name for name, flag in flags.items() if flag) or "yes"


def _clocks(d: ModelDescription) -> list[tuple[str, ...]]:
    owned: dict[str, list[str]] = {}
    for v in d.variables.values():
        for clock in v.details.clocks:
            owned.setdefault(clock, []).append(v.name)
    rows: list[tuple[str, ...]] = [("clock", "causality", "kind", "interval", "shift", "variables")]
    for v in d.variables.values():
        if v.type == "Clock":
            kind = v.details.interval_variability or ""
            ticks = kind not in ("", "triggered")
            interval, shift = map(_duration, (v.details.interval, v.details.shift))
            times = (interval, shift) if ticks else ("", "")
            rows.append((v.name, v.causality, kind, *times, ", ".join(owned.get(v.name, ()))))
    return rows


def _terminals(d: ModelDescription) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = [("terminal", "kind", "matching", "members", "description")]
    for terminal in d.terminals:
        rows += _terminal(terminal, "")
    return rows


def _terminal(t: Terminal, place: str) -> Iterator[tuple[str, ...]]:
    members = ", ".join(
        m.name if m.name == m.variable else f"{m.name} = {m.variable}" for m in t.members
    )
    yield place + t.name, t.kind, t.matching_rule, members, t.description
    for inner in t.terminals:
        yield from _terminal(inner, f"{place}{t.name}.")


def _duration(value: tuple[int, int] | float | None) -> str:
    if value is None:
        return "asked of the FMU"
    return f"{value[0]}/{value[1]} s" if isinstance(value, tuple) else f"{value:g} s"


def _variables(d: ModelDescription) -> list[tuple[str, ...]]:
    titles = (
        "variable", "type", "causality", "variability", "start", "range", "unit", "description",
    )  # fmt: skip
    rank = {"input": 0, "output": 1, "parameter": 2, "structuralParameter": 2}
    variables = sorted(d.variables.values(), key=lambda v: rank.get(v.causality, 3))
    return [titles, *map(_row, variables)]


def _row(v: Variable) -> tuple[str, ...]:
    start = " ".join(v.details.starts) if v.details.starts else v.start or ""
    shown = f" ({v.details.display_unit})" if v.details.display_unit not in (None, v.unit) else ""
    return (
        v.name, _type(v), v.causality, v.variability, start, _range(v), (v.unit or "") + shown,
        _remarks(v),
    )  # fmt: skip


def _type(v: Variable) -> str:
    """Type and sizes, a size's name where a structural parameter holds it; the declared type."""
    sizes = " × ".join(
        str(size) if isinstance(size, int) else f"{size} = {now}"
        for size, now in zip(v.dimensions, v.shape, strict=True)
    )
    declared = f" {v.details.declared_type}" if v.details.declared_type else ""
    return v.type + (f"[{sizes}]" if sizes else "") + declared


def _range(v: Variable) -> str:
    if v.details.items:
        return ", ".join(f"{number} {name}" for number, name in v.details.items)
    low, high = (None if x is None else f"{x:g}" for x in (v.minimum, v.maximum))
    if low and high:
        return f"{low} … {high}"
    return f"≥ {low}" if low else f"≤ {high}" if high else ""


def _remarks(v: Variable) -> str:
    """The description, and of what it is another name or a difference."""
    minus = "minus " if v.details.negated else ""
    remarks = [v.description] if v.description else []
    if v.details.alias_of:
        remarks.append(f"(alias of {minus}{v.details.alias_of})")
    if v.details.relative:
        remarks.append("(a difference)")
    return " ".join(remarks)
