"""Faults of an experiment file as sentences that name file, key, value and legal choices."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, ValidationError

from harness.errors import nearest
from harness.experiment import schema

_TABLES: dict[str, type[BaseModel]] = {
    "fmu": schema.FmuSpec,
    "controller": schema.ControllerSpec,
    "signal": schema.SignalSpec,
    "sensitivity": schema.SensitivitySpec,
    "connections": schema.ConnectionSpec,
    "measure": schema.MeasureSpec,
    "plots": schema.PlotSpec,
    "metrics": schema.MetricSpec,
    "sweep": schema.SweepSpec,
    "x": schema.AxisSpec,
    "y": schema.AxisSpec,
    "study": schema.StudySpec,
    "limits": schema.LimitsSpec,
    "checkpoint": schema.CheckpointSpec,
}

_FAST: dict[type[BaseModel], type[BaseModel]] = {
    schema.StudySpec: schema.FastStudySpec,
    schema.SweepSpec: schema.FastSweepSpec,
}


def describe(where: str, fault: ValidationError) -> Iterator[str]:
    """One sentence for each fault that pydantic found in the file at `where`."""
    for error in fault.errors():
        location = tuple(part for part in error["loc"] if not _is_tag(part, error["loc"]))
        key = ".".join(str(part) for part in location) or "the file"
        yield f"{where}: key {key}: {_reason(error)}"


def _is_tag(part: Any, location: tuple[Any, ...]) -> bool:
    """Whether `part` is pydantic's name of a kind of component, not a key of the file."""
    return location[:1] == ("components",) and len(location) > 2 and part is location[2]


def _reason(error: Any) -> str:
    kind, given = error["type"], error.get("input")
    if kind == "extra_forbidden":
        legal = _legal_keys(error["loc"])
        return f"unknown key; {nearest(str(error['loc'][-1]), legal)}"
    if kind == "missing":
        return "this key is required"
    if kind == "component_kind":
        return str(error["msg"])
    if kind == "literal_error":
        return f"must be one of {error['ctx']['expected']}, not {given!r}"
    message = str(error["msg"])
    return f"{message[0].lower()}{message[1:]}, not {given!r}"


def _legal_keys(location: tuple[Any, ...]) -> list[str]:
    model: type[BaseModel] = schema.ExperimentSpec
    for part in location[:-1]:
        if part == "fast":
            model = _FAST.get(model, model)
        model = _TABLES.get(str(part), model)
    return [field.alias or name for name, field in model.model_fields.items()]
