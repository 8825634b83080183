"""Directional derivatives are those of the FMU's own equations, at rest and along a run."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from fmus.declaration import Parameter
from fmus.plant import Plant
from tests.fmus.conformance.differences import derivative
from tests.fmus.conformance.excitation import STEP, Excited
from tests.fmus.packaging.instances import Instance, load

SHARE = 1e-6
POINTS = (0, 5, 24, 50)
Array = NDArray[np.float64]


@dataclass
class Point:
    """An instance in initialization mode, where every state, input and parameter can be set."""

    plant: Plant
    instance: Instance

    def __post_init__(self) -> None:
        plant, settable = self.plant, [p for p in self.plant.parameters if span(p) > 0]
        self.unknowns = [f"der({s.name})" for s in plant.states] + [v.name for v in plant.outputs]
        self.knowns = [v.name for v in (*plant.states, *plant.inputs, *settable)]
        self.sizes = [v.nominal for v in (*plant.states, *plant.inputs)] + [
            span(p) for p in settable
        ]
        self.scales = [v.nominal for v in (*plant.states, *plant.outputs)]

    def move(self, states: Sequence[float], inputs: Sequence[float]) -> None:
        names = [v.name for v in (*self.plant.states, *self.plant.inputs)]
        self.instance.set(**dict(zip(names, [*states, *inputs], strict=True)))
        self.instance.set(**{p.name: inner_value(p) for p in self.plant.parameters})

    def difference(self, name: str, size: float) -> Array:
        at = self.instance.get(name)[0]

        def values(change: float) -> Array:
            self.instance.set(**{name: at + change})
            return np.array(self.instance.get(*self.unknowns))

        found = derivative(values, size)
        self.instance.set(**{name: at})
        return found


def inner_value(p: Parameter) -> float:
    """The default, moved off a bound by a tenth of the way to the other."""
    low, high = p.minimum, p.maximum
    if low is None or high is None or low < p.value < high:
        return p.value
    return 0.9 * p.value + 0.1 * (low if p.value == high else high)


def span(p: Parameter) -> float:
    """How far a parameter may be moved both ways from `inner_value`, 0 for not at all."""
    value = inner_value(p)
    room = [abs(value - bound) for bound in (p.minimum, p.maximum) if bound is not None]
    return min(0.02 * (abs(value) or 1.0), 0.5 * min(room, default=np.inf))


@pytest.fixture
def point(plant: Plant, fmu: Path, tmp_path: Path) -> Iterator[Point]:
    instance = load(fmu, tmp_path / "fmu")
    instance.instantiate()
    instance.enter_initialization()
    yield Point(plant, instance)
    instance.fmu.freeInstance()


@pytest.mark.parametrize("row", POINTS)
def test_each_column(point: Point, excited: Excited, row: int) -> None:
    """Within 1e-6 of the entry, or of the unknown's nominal where the entry is smaller."""
    point.move(excited.states[row], excited.inputs[row])
    found = point.instance.sensitivity(point.unknowns, point.knowns)
    for name, size, column in zip(point.knowns, point.sizes, found.T, strict=True):
        expected = point.difference(name, 0.1 * size)
        error = np.abs(column - expected) * size
        assert np.all(error <= SHARE * (np.abs(column) * size + point.scales)), name


def test_after_steps_they_are_those_of_the_state_reached(
    point: Point, excited: Excited, fmu: Path, tmp_path: Path
) -> None:
    """A stepped instance and one set to the same states and inputs differ in no bit."""
    stepped = load(fmu, tmp_path / "stepped")
    stepped.instantiate()
    stepped.initialize()
    stepped.set(**{p.name: inner_value(p) for p in point.plant.parameters if p.tunable})
    fixed = {p.name: p.value for p in point.plant.parameters if not p.tunable}
    names = [v.name for v in point.plant.inputs]
    states = [s.name for s in point.plant.states]
    for k in range(10):
        stepped.set(**dict(zip(names, excited.inputs[k], strict=True)))
        stepped.step(k, STEP)
    point.move(stepped.get(*states), excited.inputs[9])
    point.instance.set(**fixed)
    found = stepped.sensitivity(point.unknowns, point.knowns)
    assert np.array_equal(found, point.instance.sensitivity(point.unknowns, point.knowns))
    stepped.fmu.freeInstance()


@pytest.mark.parametrize("version", [3], indirect=True)
def test_adjoint_is_the_transpose(point: Point, excited: Excited) -> None:
    """FMI 2 has none."""
    point.move(excited.states[24], excited.inputs[24])
    references = point.instance.references
    columns = [references[name] for name in point.knowns]
    adjoint = [
        point.instance.fmu.getAdjointDerivative([references[u]], columns, [1.0], len(columns))
        for u in point.unknowns
    ]
    assert np.array_equal(adjoint, point.instance.sensitivity(point.unknowns, point.knowns))
