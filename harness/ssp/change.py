"""What happens to a value between a source and a target: tables of values, then factor and offset.

Factors and offsets are composed as exact fractions and rounded once, so the order and number of
the connectors that a signal passes on its way leave no trace in its last bit. The unit comes
first, then the transformation:

    target = factor · unit(source) + offset

A mapping with a table of values leaves what it does not name as it is.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from harness.errors import ExperimentError, nearest
from harness.ssp.common import KINDS, LinearTransformation, MappingTransformation, Transformation
from harness.ssp.lexical import FORMS

Table = tuple[tuple[int, int], ...]
Items = Mapping[str, int]
"""The values of an enumeration by name."""


@dataclass(frozen=True)
class Change:
    """`table` first, then `factor` and `offset`."""

    table: Table = ()
    factor: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)

    def scaled(self, factor: float | Fraction, offset: float | Fraction) -> Change:
        """This, then a factor and an offset; raises `ExperimentError` where one is infinite."""
        if not (math.isfinite(factor) and math.isfinite(offset)):
            raise ExperimentError(
                f"a factor of {factor} and an offset of {offset} are not finite; give finite ones"
            )
        f, o = Fraction(factor), Fraction(offset)
        return Change(self.table, f * self.factor, f * self.offset + o)

    def mapped(self, table: Table) -> Change:
        """This, then a table; raises `ExperimentError` after a factor or offset."""
        if self.factor != 1 or self.offset != 0:
            raise ExperimentError(
                "a mapping of values cannot follow a linear transformation; put the mapping first, "
                "or the factor and the offset into its entries"
            )
        first, second = dict(self.table), dict(table)
        merged = {key: second.get(value, value) for key, value in first.items()}
        merged |= {key: value for key, value in second.items() if key not in first}
        return Change(tuple((k, v) for k, v in merged.items() if k != v))

    def boolean(self) -> Change:
        """The same for a source that is 0 or 1 only, where a table is a factor and an offset."""
        if not self.table:
            return self
        low, high = (dict(self.table).get(value, value) for value in (0, 1))
        straight = Change().scaled(Fraction(high - low), Fraction(low))
        return straight.scaled(self.factor, self.offset)

    def of(self, value: float) -> float:
        """What becomes of a value."""
        value = dict(self.table).get(value, value)  # type: ignore[call-overload]
        if not math.isfinite(value):
            return float(self.factor) * value + float(self.offset)
        return as_float(self.factor * Fraction(value) + self.offset)


def as_float(value: Fraction) -> float:
    """The nearest double; raises `ExperimentError` beyond the largest."""
    try:
        return float(value)
    except OverflowError:
        raise ExperimentError(
            "a transformation exceeds the largest double; lower its factor"
        ) from None


def transformed(
    before: Change, given: Transformation, source: Items | None, target: Items | None
) -> Change:
    """`before`, then a transformation; `source` and `target` are the ends' enumerations."""
    if isinstance(given, LinearTransformation):
        return before.scaled(given.factor, given.offset)
    return before.mapped(_table(given, source, target))


def _table(given: MappingTransformation, source: Items | None, target: Items | None) -> Table:
    kind = given.tag.partition(":")[2]
    found: dict[int, int] = {}
    for entry in given.entries:
        key = _number(kind, entry.source, source, "source")
        if key in found:
            raise ExperimentError(
                f"{kind}: the source {entry.source!r} is mapped twice; leave one entry out"
            )
        found[key] = _number(kind, entry.target, target, "target")
    return tuple(found.items())


def _number(kind: str, text: str, items: Items | None, end: str) -> int:
    form = KINDS[kind.removesuffix("MappingTransformation")]
    try:
        if form is not str:
            return int(FORMS[form].read(text))
    except ValueError as fault:
        raise ExperimentError(f"{kind}: the {end} {text!r} is {fault}") from fault
    if items is None:
        raise ExperimentError(
            f"{kind}: the {end} connector names no enumeration of the document; give its type one "
            "of ssd:Enumerations, or map integers"
        )
    if text not in items:
        hint = nearest(text, items)
        raise ExperimentError(f"{kind}: {text!r} is no item of the {end}'s enumeration; {hint}")
    return items[text]
