"""`fmu-harness info`: what an FMU says of itself, for people and as JSON."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from harness.cli.terminal import console
from harness.fmi.description.model_description import Capabilities, ModelDescription, Variable
from harness.fmi.fmu import Fmu

_LIBRARIES = {".so", ".dll", ".dylib"}


def info_command(
    fmu: Annotated[Path, typer.Argument(help="An .fmu file")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON")] = False,
) -> None:
    """Show identity, capabilities and variables of an FMU."""
    with Fmu(fmu) as opened:
        description, sha256 = opened.description, opened.sha256
        platforms = _platforms(opened.folder)
    if as_json:
        data = _as_data(description, sha256, platforms)
        typer.echo(json.dumps(data, indent=2, ensure_ascii=False))
        return
    out = console()
    out.print(_identity(description, sha256, platforms))
    if any(v.type == "Clock" for v in description.variables.values()):
        out.print(_clocks(description))
    out.print(_variables(description))


def _platforms(folder: Path) -> tuple[str, ...]:
    """The folders of `binaries` that hold a library, and "source code" where there is some."""
    binaries = (p for p in folder.glob("binaries/*/*") if p.suffix in _LIBRARIES)
    names = sorted({path.parent.name for path in binaries})
    return (*names, *(["source code"] if (folder / "sources").is_dir() else []))


def _as_data(d: ModelDescription, sha256: str, platforms: tuple[str, ...]) -> dict[str, Any]:
    plain = {f.name: getattr(d, f.name) for f in dataclasses.fields(d)}
    plain["co_simulation"] = d.co_simulation and dataclasses.asdict(d.co_simulation)
    plain["model_exchange"] = d.model_exchange and dataclasses.asdict(d.model_exchange)
    plain["variables"] = [dataclasses.asdict(v) for v in d.variables.values()]
    plain["units"] = {name: dataclasses.asdict(unit) for name, unit in d.units.items()}
    plain["feedthrough"] = dict(d.feedthrough)
    plain["display_units"] = {
        unit: {name: dataclasses.asdict(one) for name, one in shown.items()}
        for unit, shown in d.display_units.items()
    }
    plain["initial_feedthrough"] = dict(d.initial_feedthrough)
    return {"sha256": sha256, "platforms": platforms, **plain}


def _identity(d: ModelDescription, sha256: str, platforms: tuple[str, ...]) -> Table:
    table = Table(title=d.name, title_justify="left", show_header=False, box=None, padding=(0, 2))
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    table.add_row("description", d.description)
    table.add_row("FMI version", d.fmi_version)
    table.add_row("tool", d.generation_tool)
    table.add_row("token", d.token)
    table.add_row("sha256", sha256)
    table.add_row("platforms", ", ".join(platforms) or "none")
    kinds = {"co-simulation": d.co_simulation, "model exchange": d.model_exchange}
    for kind, capabilities in kinds.items():
        stepping = kind == "co-simulation"
        table.add_row(kind, "no" if capabilities is None else _capabilities(capabilities, stepping))
    if d.scheduled_execution:
        table.add_row("scheduled execution", "yes; it is not run here")
    defaults = {"start": d.start_time, "stop": d.stop_time, "step": d.step_size}
    shown = ", ".join(f"{k} {v:g} s" for k, v in defaults.items() if v is not None)
    table.add_row("default experiment", shown or "none")
    table.add_row("states", _state_names(d))
    events = d.number_of_event_indicators or len(d.event_indicators)
    if d.model_exchange is not None:
        table.add_row("event indicators", str(events))
    return table


def _state_names(d: ModelDescription) -> str:
    names = ", ".join(name for name, _ in d.states)
    unnamed = f"{d.number_of_continuous_states}, not named" * (d.number_of_continuous_states > 0)
    return escape(names or unnamed or "none")


def _capabilities(c: Capabilities, stepping: bool) -> str:
    flags = {
        "get and set state": c.can_get_and_set_fmu_state,
        "serialise state": c.can_serialize_fmu_state,
        "directional derivatives": c.provides_directional_derivatives,
        "adjoint derivatives": c.provides_adjoint_derivatives,
        "variable step": stepping and c.can_handle_variable_step,
        "event mode": c.has_event_mode,
        "early return": c.might_return_early,
        "interpolates inputs": c.can_interpolate_inputs,
        "one instance a process": c.can_be_instantiated_only_once,
        "needs its tool installed": c.needs_execution_tool,
        f"fixed internal step {c.fixed_internal_step_size or 0:g} s": c.fixed_internal_step_size,
    }
    return ", ".join(name for name, flag in flags.items() if flag) or "yes"


def _clocks(d: ModelDescription) -> Table:
    table = Table(box=None, padding=(0, 1))
    for title in ("clock", "causality", "kind", "interval", "shift", "variables"):
        table.add_column(title)
    for v in d.variables.values():
        if v.type == "Clock":
            kind, owned = v.details.interval_variability or "", _owned(d, v.name)
            ticks = kind not in ("", "triggered")
            times = (
                _duration(v.details.interval) if ticks else "",
                _duration(v.details.shift) if ticks else "",
            )
            table.add_row(*map(escape, (v.name, v.causality, kind, *times, owned)))
    return table


def _owned(d: ModelDescription, clock: str) -> str:
    """The variables that this clock drives."""
    return ", ".join(v.name for v in d.variables.values() if clock in v.details.clocks)


def _duration(value: tuple[int, int] | float | None) -> str:
    if value is None:
        return "asked of the FMU"
    return f"{value[0]}/{value[1]} s" if isinstance(value, tuple) else f"{value:g} s"


def _variables(d: ModelDescription) -> Table:
    table = Table(box=None, padding=(0, 1))
    for title, justify in (
        ("variable", "left"), ("type", "left"), ("causality", "left"), ("variability", "left"),
        ("start", "right"), ("range", "left"), ("unit", "left"), ("description", "left"),
    ):  # fmt: skip
        table.add_column(title, justify=justify)  # type: ignore[arg-type]
    rank = {"input": 0, "output": 1, "parameter": 2, "structuralParameter": 2}
    for v in sorted(d.variables.values(), key=lambda v: rank.get(v.causality, 3)):
        table.add_row(*map(escape, _row(v)))
    return table


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
