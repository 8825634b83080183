"""The generated parts of a plant's README: variables, parameters with sources, eigenvalues.

    python -m fmus.variable_table          rewrites them in every plant's README

They stand between the lines `<!-- begin: NAME -->` and `<!-- end: NAME -->`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path

import numpy as np

from fmus.linearization import WorkingPoint, equilibrium, linearize
from fmus.plant import Plant

PLANTS = tuple(sorted(path.parent.name for path in Path(__file__).parent.glob("*/model.py")))

_ROUNDING = 1e-9  # in 1/s: a smaller real part is the rounding of one that is zero


class ReadmeError(Exception):
    """A README lacks the place of a generated part."""


def readme_path(name: str) -> Path:
    """The README of the plant called `name`."""
    return Path(__file__).parent / name / "README.md"


def current_readme(name: str) -> str:
    """The text of a plant's README with its generated parts up to date.

    Raises `ReadmeError` when a part has no place in it.
    """
    module = import_module(f"fmus.{name}.model")
    text = readme_path(name).read_text(encoding="utf-8")
    for part, content in _parts(module.plant, module.WORKING_POINTS).items():
        pattern = rf"(<!-- begin: {part} -->\n).*?(<!-- end: {part} -->)"
        found = re.search(pattern, text, flags=re.DOTALL)
        if found is None:
            raise ReadmeError(
                f"{readme_path(name)} has no lines '<!-- begin: {part} -->' and "
                f"'<!-- end: {part} -->', where its generated part '{part}' belongs"
            )
        text = text[: found.end(1)] + content + text[found.start(2) :]
    return text


def _parts(plant: Plant, working_points: Iterable[WorkingPoint]) -> dict[str, str]:
    states = [
        (f"`{s.name}`", s.unit, _g(s.start), _g(s.nominal), s.description) for s in plant.states
    ]
    inputs = [(f"`{v.name}`", v.unit, _g(v.start), v.description) for v in plant.inputs]
    outputs = [(f"`{v.name}`", v.unit, v.description) for v in plant.outputs]
    parameters = [
        (
            f"`{q.name}`",
            _g(q.value),
            q.unit,
            q.description,
            "yes" if q.tunable else "no",
            q.source,
        )
        for q in plant.parameters
    ]
    return {
        "states": _table(("state", "unit", "start", "nominal", "meaning"), states),
        "inputs": _table(("input", "unit", "start", "meaning"), inputs),
        "outputs": _table(("output", "unit", "meaning"), outputs),
        "parameters": _table(
            ("parameter", "value", "unit", "meaning", "tunable", "source"), parameters
        ),
        "eigenvalues": _table(
            ("working point", "command", "eigenvalues in 1/s"),
            [_eigenvalues(plant, point) for point in working_points],
        ),
    }


def _eigenvalues(plant: Plant, point: WorkingPoint) -> tuple[str, str, str]:
    x, u = equilibrium(plant, point.inputs, point.output, point.target)
    values = linearize(plant, x, u).eigenvalues()
    command = 0.0 if abs(u[0]) < 1e-9 else u[0]
    shown = ", ".join(_complex(value) for value in values if value.imag >= 0)
    return point.description, f"{command:.3g}", shown


def _complex(value: np.complex128) -> str:
    real = value.real if abs(value.real) > _ROUNDING else 0.0
    if value.imag == 0:
        return f"{real:.3g}"
    return f"{real:.3g} ± {value.imag:.3g} i"


def _g(value: float) -> str:
    return f"{value:.6g}"


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "".join("| " + " | ".join(cells) + " |\n" for cells in lines)


def main() -> None:
    """Rewrite the generated parts of every plant's README."""
    for name in PLANTS:
        text = current_readme(name)
        readme_path(name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
