"""How the tables of an experiment go together: a file and the one that it extends, a variant and
what it changes, and settings over all of them."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.errors import ExperimentError
from harness.experiment.faults import read_toml
from harness.experiment.schema import KINDS

Table = dict[str, Any]
_Path = tuple[str, ...]

DEEPEST = 8
"""How many files may extend one another, and variants be like one another."""


def merge(base: Table, changes: Mapping[str, Any], *, components: bool = True) -> Table:
    """`base` with `changes`: tables are merged, everything else is replaced. A component that
    becomes another one is replaced, unless `components` are to be merged like other tables, so that
    no parameters of the old one remain."""
    merged = copy.deepcopy(base)
    for key, value in changes.items():
        old: Any = merged.get(key)
        tables = isinstance(value, dict) and isinstance(old, dict)
        if tables and not (components and _other(old, value)):
            merged[key] = merge(old, value, components=components)
        else:
            merged[key] = copy.deepcopy(value)
    return merged


def _other(old: Mapping[str, Any], new: Mapping[str, Any]) -> bool:
    """Whether both tables say what a component is, and differ in it."""
    before, after = (
        {kind: table[kind] for kind in KINDS if isinstance(table.get(kind), str)}
        for table in (old, new)
    )
    return bool(before and after and before != after)


def read_experiment(path: Path, depth: int = 0) -> Table:
    """The content of a file over that of the one that it extends; raises `ExperimentError`."""
    data = read_toml(path, "experiment file")
    wires = data.get("connections")
    if isinstance(wires, dict):  # so that a variant can add to a wire that is a plain string
        data["connections"] = {target: _wire(wire) for target, wire in wires.items()}
    base = data.get("extends")
    if base is None:
        return data
    if not isinstance(base, str) or depth >= DEEPEST:
        raise ExperimentError(
            f"{path}: key extends: must name one other file, in a chain of at most {DEEPEST}, "
            f"not {base!r}"
        )
    return merge(read_experiment(path.parent / base, depth + 1), data)


def _wire(wire: Any) -> Any:
    return {"from": wire} if isinstance(wire, str) else wire


def with_settings(data: Table, settings: Mapping[str, Any]) -> Table:
    """The content of a file with `settings`, which win over what its variants state.

    A variant in which a component is another one has keys of its own: there a setting of that
    component counts where the variant states it too, and else a warning says that it does not.
    """
    merged = merge(data, settings)
    variants = data.get("variants")
    if not isinstance(variants, dict):
        return merged
    common = {key: value for key, value in settings.items() if key != "variants"}
    for name, own in variants.items():
        if isinstance(own, dict):
            changed = _over(name, data, common)
            merged["variants"][name] = merge(changed, settings.get("variants", {}).get(name, {}))
    return merged


def _over(name: str, data: Table, settings: Mapping[str, Any]) -> Table:
    """What a variant states itself, with the settings that it, or one that it is like, states."""
    own: Table = data["variants"][name]
    changes = inherited(data["variants"], name)
    if changes.get("standalone"):
        return merge(own, settings)
    for path, value in _leaves(settings):
        place = changes
        for depth, key in enumerate(path):
            if isinstance(place, str):  # a wire, of which the variant says no more than its source
                place = {"from": place}
                own = merge(own, nested(path[:depth], place))
            if not isinstance(place, dict) or key not in place:
                _warn_where_replaced(name, data, changes, path)
                break
            place = place[key]
        else:
            own = merge(own, nested(path, value))
    return own


def inherited(variants: Mapping[str, Table], name: str, depth: int = 0) -> Table:
    """What a variant changes, over what those change that it is like."""
    own = variants.get(name)
    if not isinstance(own, dict) or depth >= DEEPEST:
        return {}
    return merge(inherited(variants, own.get("like", ""), depth + 1), own, components=False)


def _leaves(table: Mapping[str, Any], path: _Path = ()) -> Iterator[tuple[_Path, Any]]:
    """What settings set, by its path; a component that becomes another one as a whole."""
    for key, value in table.items():
        whole = path == ("components",) and any(kind in value for kind in KINDS)
        if isinstance(value, dict) and value and not whole:
            yield from _leaves(value, (*path, key))
        else:
            yield (*path, key), value


def nested(path: Sequence[str], value: Any) -> Table:
    """The table in which `value` has that path of keys."""
    for key in reversed(path):
        value = {key: value}
    table: Table = value
    return table


def _warn_where_replaced(name: str, data: Table, changes: Table, path: _Path) -> None:
    if path[0] != "components" or len(path) < 3:
        return
    before, after = (table.get("components", {}).get(path[1], {}) for table in (data, changes))
    if isinstance(before, dict) and isinstance(after, dict) and _other(before, after):
        warnings.warn(
            f"the setting {'.'.join(path)} does not reach variant {name}, in which {path[1]} is "
            f"another component; variants.{name}.{'.'.join(path)} does",
            stacklevel=2,
        )
