"""The checks of how outputs and derivatives answer to inputs and states: at once, and how steeply.

Directional derivatives are compared with central differences at three increments; who agrees at
one of them is right, since small ones drown in rounding and large ones in curvature. In
co-simulation the states cannot be moved, so there derivatives by states are called and must be
finite; in model exchange they are compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.fmi.binding.instance import FmuInstance
from harness.fmi.description.model_description import Variable
from harness.inspection.excitation import scale_of, within
from harness.inspection.finding import Finding, claimed, failed, passed, require
from harness.inspection.problem import listed
from harness.inspection.subject import Array, Subject
from harness.inspection.trial import Trial, running

_RELATIVE = 1e-4  # agreement of derivatives with finite differences
_INCREMENTS = (1e-6, 1e-4, 1e-3)  # of a variable's scale
_FLAG = "providesDirectionalDerivatives"
_INSTANTS = (0, 3, 5)  # steps before each look


def feeds_through_as_declared(subject: Subject) -> Finding:
    """Outputs that jump with an input are those of the model structure."""
    require(subject.real_inputs and subject.real_outputs, "no real inputs or no real outputs")
    observed: set[tuple[str, str]] = set()
    with running(subject) as trial:
        before = 0
        for steps in _INSTANTS:
            trial.advance(steps, first=before)
            before += steps
            if trial.ended:
                break
            observed |= _jumps(subject, trial.instance)
            trial.inputs.forget()
    declared = subject.description.feedthrough
    hidden = sorted(
        f"{output} on {name}"
        for output, name in observed
        if (said := declared.get(output)) is not None and name not in said
    )
    if hidden:
        lie = f"dependencies of {hidden[0].split(' on ')[0]}"
        return failed(f"undeclared: {listed(hidden)}", lie)
    silent = sorted(output for output, said in declared.items() if said is None)
    note = f"; no statement for {len(silent)} outputs" if silent else ""
    return passed(f"{len(observed)} observed{note}", observed=sorted(map(list, observed)))


def _jumps(subject: Subject, instance: FmuInstance) -> set[tuple[str, str]]:
    def outputs() -> list[Any]:
        return [instance.get(v.name) for v in subject.real_outputs]

    found = set()
    for variable in subject.real_inputs:
        before, value = outputs(), float(instance.get(variable.name))
        step = 0.1 * scale_of(variable)
        moved = (within(variable, value + step), within(variable, value - step))
        instance.set({variable.name: next((one for one in moved if one != value), value)})
        after = outputs()
        instance.set({variable.name: value})
        pairs = zip(subject.real_outputs, before, after, strict=True)
        found |= {(output.name, variable.name) for output, a, b in pairs if a != b}
    return found


@dataclass(frozen=True)
class _Known:
    """A variable to differentiate by; `move` sets it, None where nothing outside may."""

    variable: Variable
    scale: float
    centre: float
    move: Callable[[float], None] | None


@dataclass(frozen=True)
class _Worst:
    """The derivative that is farthest from what it should be: 1 `excess` is just allowed."""

    excess: float = 0.0
    words: str = ""


def differentiates(subject: Subject) -> Finding:
    """Directional derivatives of outputs and state derivatives agree with central differences."""
    require(subject.capabilities.provides_directional_derivatives, f"{_FLAG} is false")
    unknowns = [*(rate for _, rate in subject.states), *subject.real_outputs]
    with running(subject) as trial:
        trial.advance(_INSTANTS[1])
        require(not trial.ended, "the FMU ends the simulation at once")
        knowns = [*_inputs(subject, trial), *_states(subject, trial)]
        nothing = "nothing to differentiate: no scalar outputs, inputs or states"
        require(unknowns and knowns, nothing)
        worst = _Worst()
        for known in knowns:
            with claimed(_FLAG):
                names = [v.name for v in unknowns]
                exact = trial.instance.directional_derivative(names, known.variable.name)
            if not np.isfinite(exact).all():
                return failed(f"the derivatives by {known.variable.name} are not finite", _FLAG)
            found = _judged(subject, trial, unknowns, known, exact)
            worst = max(worst, found, key=lambda one: one.excess)
    if worst.excess > 1.0:
        return failed(worst.words, _FLAG)
    compared = sum(known.move is not None for known in knowns)
    called = len(knowns) - compared
    more = f"; by {called} states finite, not compared" if called else ""
    return passed(f"{len(unknowns)} unknowns by {compared} knowns agree{more}")


def _judged(
    subject: Subject, trial: Trial, unknowns: list[Variable], known: _Known, exact: Array
) -> _Worst:
    name = known.variable.name
    for v, value in zip(unknowns, exact, strict=True):
        itself = v.value_reference == known.variable.value_reference
        if itself and abs(value - 1.0) > _RELATIVE:
            return _Worst(np.inf, f"d {v.name} / d {name} is {value:g}, though they are one")
    if known.move is None:
        return _Worst()
    excess, numeric = _excess(subject, trial, unknowns, known, exact)
    i = int(excess.argmax())
    words = f"d {unknowns[i].name} / d {name} is {exact[i]:g}, its finite difference {numeric[i]:g}"
    return _Worst(float(excess[i]), words)


def _inputs(subject: Subject, trial: Trial) -> Iterator[_Known]:
    instance = trial.instance
    for v in subject.real_inputs:

        def move(value: float, name: str = v.name) -> None:
            instance.set({name: value})

        centre = float(instance.get(v.name))
        yield _Known(v, max(scale_of(v), abs(centre)), centre, move)


def _states(subject: Subject, trial: Trial) -> Iterator[_Known]:
    if not trial.solves:
        yield from (_Known(state, 1.0, 0.0, None) for state, _ in subject.states)
        return
    part = trial.part
    x, nominal = part.states(), part.nominals()
    for i, (state, _) in enumerate(subject.states):

        def move(value: float, i: int = i) -> None:
            moved = x.copy()
            moved[i] = value
            part.set_states(moved)

        scale = max(float(nominal[i]), abs(float(x[i])))
        yield _Known(state, scale, float(x[i]), move)


def _excess(
    subject: Subject, trial: Trial, unknowns: list[Variable], known: _Known, exact: Array
) -> tuple[Array, Array]:
    """How far each derivative is from its central difference, 1 where that is just allowed, and
    that difference."""
    best, nearest = np.full(len(unknowns), np.inf), np.zeros(len(unknowns))
    assert known.move is not None
    for increment in (share * known.scale for share in _INCREMENTS):
        rows = []
        for value in (known.centre + increment, known.centre - increment):
            known.move(value)
            rows.append(np.array([trial.instance.get(v.name) for v in unknowns]))
        known.move(known.centre)
        numeric = (rows[0] - rows[1]) / (2 * increment)
        rounding = 8 * np.finfo(float).eps * np.maximum(*np.abs(rows)) / increment
        allowed = _RELATIVE * np.maximum(np.abs(numeric), np.abs(exact)) + rounding
        excess = np.abs(exact - numeric) / np.maximum(allowed, np.finfo(float).tiny)
        if not subject.exchanges:  # derivatives that only a step brings up to date say nothing
            n = len(subject.states)
            excess[:n][rows[0][:n] == rows[1][:n]] = 0.0
        nearest = np.where(excess < best, numeric, nearest)
        best = np.minimum(best, excess)
    return best, nearest
