"""Reading files of experiments and claims: faults name file, key, value and legal choices."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin

from pydantic import BaseModel, ValidationError

from harness.errors import ExperimentError, nearest
from harness.experiment import schema

M = TypeVar("M", bound=BaseModel)


def read_toml(path: Path, what: str) -> dict[str, Any]:
    """The content of a file, called `what` in the `ExperimentError` where it cannot be read."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as fault:
        raise ExperimentError(f"{what} {path} cannot be read: {fault}") from fault
    except tomllib.TOMLDecodeError as fault:
        raise ExperimentError(f"{what} {path} is no valid TOML: {fault}") from fault


def checked(kind: type[M], data: dict[str, Any], where: str) -> M:
    """The content of the file at `where` in its form; raises `ExperimentError`, a line a fault."""
    try:
        return kind.model_validate(data)
    except ValidationError as fault:
        raise ExperimentError("\n".join(_sentences(where, fault))) from fault


def _sentences(where: str, fault: ValidationError) -> Iterator[str]:
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
    message = message.removeprefix("Value error, ")
    message = f"{message[0].lower()}{message[1:]}"
    return message if isinstance(given, dict) else f"{message}, not {given!r}"


def _legal_keys(location: tuple[Any, ...]) -> list[str]:
    """The keys of the table at `location`, which begins at the file."""
    models: list[type[BaseModel]] = [schema.ExperimentSpec]
    is_name = False  # whether the next part is a name that the user gave
    for part in location[:-1]:
        if not is_name:
            fields = [(name, f) for model in models for name, f in model.model_fields.items()]
            types = [f.annotation for name, f in fields if part in (name, f.alias)]
            is_name = any(get_origin(one) is dict for one in types)
            # pydantic's name of a kind of component is the key that says what it is
            of_kind = [one for one in models if part in one.model_fields]
            models = [model for one in types for model in _models(one)] or of_kind or models
        else:
            is_name = False
    return [f.alias or name for model in models for name, f in model.model_fields.items()]


def _models(annotation: Any) -> list[type[BaseModel]]:
    """The tables of which a type is made."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for one in get_args(annotation) for model in _models(one)]
