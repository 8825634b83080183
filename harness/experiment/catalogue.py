"""What there is to run, wire and measure, described: ports, units, parameters, an example.

Plants are asked by their FMU and controllers by their block, so that what is said here is what a
system finds; meanings are those of the docstrings.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Any

from harness import registry
from harness.errors import UsageError, nearest
from harness.fmi.fmu import Fmu
from harness.instruments.imperfections import IMPERFECTIONS
from harness.instruments.signals import SIGNALS
from harness.results import metrics
from harness.results.metrics import FIGURES
from harness.results.step_response import StepMetrics, TrackingMetrics

Rows = tuple[tuple[str, ...], ...]
_PLACEHOLDERS: Mapping[str, Any] = {"float": 1.0, "int": 1, "tuple[float, ...]": (1.0,)}
_FIGURES = {
    "rms": "The root of the mean square of the values.",
    "mean": "The mean of the values.",
    "mean_abs": "The mean of their magnitudes.",
    "max_abs": "The largest of their magnitudes, on both sides of events.",
    "std": "Their standard deviation.",
    "final": "The last value.",
    "final_abs": "The magnitude of the last value.",
    "largest_fall": "How far the values fall from what they had reached before.",
}


@dataclass(frozen=True)
class Description:
    """One thing by its `name` and `kind`: `text` says what it is, `ports` are rows (port,
    direction, unit, meaning), `parameters` rows (parameter, default, unit, meaning), `example` is a
    line for a script."""

    name: str
    kind: str
    text: str
    ports: Rows = ()
    parameters: Rows = ()
    example: str = ""


def known() -> dict[str, tuple[str, ...]]:
    """The names of all that can be described, by kind."""
    measured = (one.name for cls in (StepMetrics, TrackingMetrics) for one in fields(cls))
    skipped = {"start", "initial", "final", "band", "tracking"}
    return {
        "plant": tuple(registry.names(registry.PLANTS)),
        "controller": tuple(registry.names(registry.CONTROLLERS)),
        "signal": tuple(SIGNALS),
        "imperfection": tuple(IMPERFECTIONS),
        "metric": (*dict.fromkeys([*FIGURES, *(m for m in measured if m not in skipped)]),),
    }


def describe(name: str) -> list[Description]:
    """All that bears this name, or the controller "module:Class"; raises `UsageError` with near
    names."""
    makers = {
        "plant": _plant, "controller": _controller, "signal": _signal,
        "imperfection": _imperfection, "metric": _metric,
    }  # fmt: skip
    names = known()
    found = [makers[kind](name) for kind, own in names.items() if name in own]
    if not found and ":" in name:
        found = [_controller(name)]
    if not found:
        every = [one for own in names.values() for one in own]
        raise UsageError(f"nothing is called {name!r}; {nearest(name, every)}")
    return found


def _plant(name: str) -> Description:
    plant = registry.plant(name)
    with Fmu(registry.plant_fmu(name)) as fmu:
        variables = [v for v in fmu.description.variables.values() if v.causality != "local"]
    ports = tuple(
        (v.name, v.causality, v.unit or "", v.description)
        for v in variables
        if v.causality in ("input", "output")
    )
    parameters = tuple(
        (v.name, v.start or "", v.unit or "", v.description)
        for v in variables
        if v.causality in ("parameter", "structuralParameter")
    )
    example = f'bench.fmu("plant", "{name}")'
    return Description(name, "plant", plant.description, ports, parameters, example)


def _controller(name: str) -> Description:
    source = registry.controller(name)
    text, own = inspect.getdoc(source) or "", _fields(source)
    needed = ", ".join(f"{row[0]}=…" for row in own if not row[1])
    example = f'bench.controller("controller", "{name}"{", " * bool(needed)}{needed})'
    return Description(name, "controller", text, _ports(source), own, example)


def _ports(source: Any) -> Rows:
    """The ports of a controller's block; none where they depend on parameters that have no default
    and no plain type."""
    try:
        given = {}
        for one in fields(source) if dataclasses.is_dataclass(source) else ():
            if one.default is MISSING and one.default_factory is MISSING and one.init:
                given[one.name] = _PLACEHOLDERS[str(one.type)]
        block = source(**given).block(0.01)
    except Exception:  # whatever a class says to placeholders
        return ()
    ends = [("input", one) for one in block.inputs] + [("output", one) for one in block.outputs]
    return tuple((s.name, way, s.unit or "", s.description) for way, s in ends)


def _signal(name: str) -> Description:
    kind, own = SIGNALS[name], _fields(SIGNALS[name])
    port = (("value", "output", "as `unit` says", "the value at each sample"),)
    needed = "".join(f", {row[0]}=…" for row in own if not row[1])
    example = f'bench.signal("signal", "{name}"{needed})'
    return Description(name, "signal", inspect.getdoc(kind) or "", port, own, example)


def _imperfection(name: str) -> Description:
    kind, own = IMPERFECTIONS[name], _fields(IMPERFECTIONS[name])
    needed = ", ".join(f'"{row[0]}": …' for row in own if not row[1] or row is own[0])
    example = f'bench.connect("plant.y", "controller.measured", {name}={{{needed}}})'
    return Description(name, "imperfection", inspect.getdoc(kind) or "", (), own, example)


def _metric(name: str) -> Description:
    if name in FIGURES:
        example = f'[metrics.own]\nkind = "{name}"\nsignal = "plant.y"'
        return Description(name, "metric", _FIGURES.get(name, ""), example=example)
    unit = next(
        one.metadata["unit"] for cls in (StepMetrics, TrackingMetrics) for one in fields(cls)
        if one.name == name
    )  # fmt: skip
    function = getattr(metrics, name, None)
    text = inspect.getdoc(function) if function is not None else inspect.getdoc(TrackingMetrics)
    shown = unit.format(y="unit of the response", u="unit of the control")
    text = f"{text}\n\nUnit: {shown}. Of an experiment with [measure]; in `metrics.csv`."
    return Description(name, "metric", text, example=f'[study]\nmetrics = ["{name}"]')


def _fields(kind: Any) -> Rows:
    """Rows of the parameters of a class or function, with what its docstrings say of them."""
    module = sys.modules.get(getattr(kind, "__module__", ""))
    owners = [*(one for one in getattr(kind, "__mro__", (kind,)) if one is not object), module]
    docs = [inspect.getdoc(one) or "" for one in owners]
    try:
        given = inspect.signature(kind).parameters.values()
    except (TypeError, ValueError):
        return ()
    return tuple(
        (p.name, "" if p.default is p.empty else _shown(p.default), *_meaning(p.name, docs))
        for p in given
        if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
    )


def _shown(default: Any) -> str:
    if dataclasses.is_dataclass(default):
        return type(default).__name__
    return "a value of its own" if "factory" in repr(default) else repr(default)


def _meaning(name: str, docs: Sequence[str]) -> tuple[str, str]:
    """Unit and meaning of a parameter: the row of a table in a docstring, or the sentence that has
    it in code style."""
    row = re.compile(
        rf"^(?:\w+, )*{re.escape(name)}(?:, \w+)*[ ]{{2,}}(\S.*(?:\n[ ]{{8,}}.*)*)$", re.M
    )
    for doc in docs:
        if found := row.search(doc):
            text = " ".join(found[1].split())
            unit = re.search(r" \[([^]]+)\]$", text)
            return (unit[1], text[: unit.start()]) if unit else ("", text)
    for doc in docs:
        for sentence in _sentences(doc):
            if f"`{name}`" in sentence and sentence != " ".join(doc.split()):
                return "", sentence
    return "", ""


def _sentences(doc: str) -> Iterator[str]:
    for paragraph in doc.split("\n\n"):
        yield from re.split(r"(?<=[.;])\s+", " ".join(paragraph.split()))


def hint(name: str) -> str:
    """What to type for a name that is no file, or nothing."""
    kinds: Sequence[str] = [kind for kind, names in known().items() if name in names]
    return f"{name} is a {kinds[0]}: `fmu-harness describe {name}`" if kinds else ""
