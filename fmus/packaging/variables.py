"""Variables and dependencies of an FMU as FMI sees them, the same for plants and blocks.

This module refuses to know XML; `model_description.py` writes it for each version.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class VariableEntry:
    """One variable of the XML in neutral form; the value reference is its place in the list."""

    name: str
    causality: str
    variability: str
    unit: str
    description: str = ""
    initial: str | None = None
    start: float | None = None
    nominal: float = 1.0
    minimum: float | None = None
    maximum: float | None = None
    derivative_of: int | None = None


@dataclass(frozen=True)
class Unknown:
    """An unknown and the knowns it depends on, as value references in ascending order."""

    reference: int
    dependencies: tuple[int, ...]
    kinds: tuple[str, ...]


@dataclass(frozen=True)
class ModelStructure:
    """The three lists of ModelStructure; initial unknowns are in the order of references."""

    outputs: tuple[Unknown, ...]
    derivatives: tuple[Unknown, ...]
    initial_unknowns: tuple[Unknown, ...]
