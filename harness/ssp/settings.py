"""What the harness says in a description that SSP has no words for: annotations of our own.

Sample times, delays, imperfections, seeds, recorded signals, metrics and plots stand as JSON in an
annotation of type `TYPE`, at the element that they concern: the description, a component, a
connection. So they stay true when another tool changes the rest. Other tools' annotations are
read here for one thing only: the step of their fixed-step algorithm.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterable, Mapping
from html import escape
from itertools import chain, count
from typing import Any

from harness.errors import ExperimentError, nearest
from harness.ssp import markup
from harness.ssp.common import Annotation
from harness.ssp.document import SystemStructure
from harness.ssp.lexical import read_double

TYPE = "fmu-harness.settings"
"""The name under which our annotations stand, beside `fmu-harness.*` in `extra/` of FMUs."""

NAMESPACE = "urn:fmu-harness:settings:1"
_TAG = f"{{{NAMESPACE}}}Settings"
_SAFE_NAME = re.compile(r"[^\w .()+-]|^[. ]+")

OSP_TYPE = "com.opensimulationplatform"
OSP_NAMESPACE = ("osp", markup.OSP)
"""Prefix and namespace, to be declared by the root element: libcosim takes a declaration within
`osp:Algorithm` for an algorithm that it does not know."""

_STEPS = {"FixedStepAlgorithm": "baseStepSize", "FixedStepMaster": "stepSize"}


def settings_of(
    annotations: Iterable[Annotation], legal: Iterable[str], where: str
) -> dict[str, Any]:
    """Our settings among annotations; raises `ExperimentError` for what is none of `legal`."""
    found: dict[str, Any] = {}
    for one in annotations:
        if one.type == TYPE:
            found |= _read(one, where)
    legal = tuple(legal)
    for key in found:
        if key not in legal:
            raise ExperimentError(f"{where}: annotation {TYPE}: key {key!r}; {nearest(key, legal)}")
    return found


def annotation(settings: Mapping[str, Any]) -> tuple[Annotation, ...]:
    """The annotation that `settings_of` reads, none for none; raises `ExperimentError`."""
    if not settings:
        return ()
    try:
        content = json.dumps(dict(settings), ensure_ascii=False)
    except (TypeError, ValueError) as fault:
        raise ExperimentError(
            f"settings cannot be written as JSON: {fault}; give texts, numbers, lists and tables"
        ) from fault
    xml = f'<Settings xmlns="{NAMESPACE}">{escape(content, quote=False)}</Settings>'
    return (Annotation(type=TYPE, more=(markup.canonical(markup.parsed(xml)),)),)


def fixed_step(structure: SystemStructure) -> tuple[float, str] | None:
    """The step that another tool's annotation states, and the type of that annotation."""
    of_experiment = structure.experiment.annotations if structure.experiment else ()
    for one in (*of_experiment, *structure.system.annotations, *structure.annotations):
        for element in (e for content in one.more for e in markup.parsed(content).iter("{*}*")):
            name = _STEPS.get(element.tag.rpartition("}")[2])
            if name and element.get(name):
                return _step(element.get(name), one.type)
    return None


def osp_step(step: float) -> Annotation:
    """The annotation by which libcosim and its kin learn the step (s)."""
    prefix, uri = OSP_NAMESPACE
    xml = (
        f'<osp:Algorithm xmlns:{prefix}="{uri}">'
        f'<osp:FixedStepAlgorithm baseStepSize="{step!r}"></osp:FixedStepAlgorithm></osp:Algorithm>'
    )
    return Annotation(type=OSP_TYPE, more=(markup.canonical(markup.parsed(xml)),))


def safe_name(name: str) -> str:
    """A name that is fit for a file or a column: what is not becomes "_"."""
    return _SAFE_NAME.sub("_", name)[:120].strip() or "_"


def unique(name: str, taken: Collection[str], suffix: str = "") -> str:
    """`name` and `suffix`, with a number between them where that is `taken`."""
    numbered = (f"{name}_{number}{suffix}" for number in count(2))
    return next(one for one in chain([name + suffix], numbered) if one not in taken)


def check_names(settings: Mapping[str, Any], where: str) -> None:
    """Names that become names of files must be fit for it; raises `ExperimentError`."""
    for table in ("plots", "metrics"):
        for name in settings.get(table) or {}:
            if safe_name(name) != name:
                raise ExperimentError(
                    f"{where}: {table}: the name {name!r} is not fit for a file; take one such as "
                    f"{safe_name(name)!r}"
                )


def _read(one: Annotation, where: str) -> dict[str, Any]:
    for content in one.more:
        element = markup.parsed(content)
        if element.tag != _TAG:
            continue
        try:
            found = json.loads(element.text or "")
        except (ValueError, RecursionError) as fault:
            raise ExperimentError(
                f"{where}: annotation {TYPE} is no JSON: {fault}; mend it, or leave it out"
            ) from fault
        if not isinstance(found, dict):
            raise ExperimentError(
                f'{where}: annotation {TYPE} holds no JSON object; write one, such as {{"seed": 7}}'
            )
        return found
    raise ExperimentError(f"{where}: annotation {TYPE} holds no element {_TAG}; add it")


def _step(given: str, kind: str) -> tuple[float, str] | None:
    try:
        value = read_double(given)
    except ValueError:
        return None
    return (value, kind) if 0.0 < value < float("inf") else None
