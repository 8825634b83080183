"""`fmu-harness info`: what an FMU says of itself, for people and as JSON."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from harness.cli.terminal import console
from harness.fmi.fmu import Fmu
from harness.fmi.model_description import Capabilities, ModelDescription, Variable


def info_command(
    fmu: Annotated[Path, typer.Argument(help="An .fmu file")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON")] = False,
) -> None:
    """Show identity, capabilities and variables of an FMU."""
    with Fmu(fmu) as opened:
        description, sha256 = opened.description, opened.sha256
    if as_json:
        typer.echo(json.dumps(_as_data(description, sha256), indent=2, ensure_ascii=False))
        return
    out = console()
    out.print(_identity(description, sha256))
    out.print(_variables(description))


def _as_data(d: ModelDescription, sha256: str) -> dict[str, Any]:
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
    return {"sha256": sha256, **plain}


def _identity(d: ModelDescription, sha256: str) -> Table:
    table = Table(title=d.name, title_justify="left", show_header=False, box=None, padding=(0, 2))
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    table.add_row("description", d.description)
    table.add_row("FMI version", d.fmi_version)
    table.add_row("tool", d.generation_tool)
    table.add_row("token", d.token)
    table.add_row("sha256", sha256)
    kinds = {"co-simulation": d.co_simulation, "model exchange": d.model_exchange}
    for kind, capabilities in kinds.items():
        table.add_row(kind, "no" if capabilities is None else _capabilities(capabilities))
    if d.scheduled_execution:
        table.add_row("scheduled execution", "yes; it is not run here")
    defaults = {"start": d.start_time, "stop": d.stop_time, "step": d.step_size}
    shown = ", ".join(f"{k} {v:g} s" for k, v in defaults.items() if v is not None)
    table.add_row("default experiment", shown or "none")
    table.add_row("states", ", ".join(name for name, _ in d.states) or "none")
    return table


def _capabilities(c: Capabilities) -> str:
    flags = {
        "get and set state": c.can_get_and_set_fmu_state,
        "serialise state": c.can_serialize_fmu_state,
        "directional derivatives": c.provides_directional_derivatives,
        "adjoint derivatives": c.provides_adjoint_derivatives,
        "variable step": c.can_handle_variable_step,
        "event mode": c.has_event_mode,
        "one instance a process": c.can_be_instantiated_only_once,
    }
    return ", ".join(name for name, flag in flags.items() if flag) or "yes"


def _variables(d: ModelDescription) -> Table:
    table = Table(box=None, padding=(0, 1))
    for title, justify in (
        ("variable", "left"), ("type", "left"), ("causality", "left"), ("variability", "left"),
        ("start", "right"), ("unit", "left"), ("description", "left"),
    ):  # fmt: skip
        table.add_column(title, justify=justify)  # type: ignore[arg-type]
    rank = {"input": 0, "output": 1, "parameter": 2, "structuralParameter": 2}
    for v in sorted(d.variables.values(), key=lambda v: rank.get(v.causality, 3)):
        table.add_row(*map(_escape, _row(v)))
    return table


def _row(v: Variable) -> tuple[str, ...]:
    kind = v.type if v.size == 1 else f"{v.type}[{v.size}]"
    return v.name, kind, v.causality, v.variability, v.start or "", v.unit or "", v.description


def _escape(text: str) -> str:
    return text.replace("[", r"\[")
