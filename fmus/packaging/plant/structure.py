"""Who depends on whom: the ModelStructure of an FMU from the sparsity of its Jacobian.

Kinds are FMI's: `constant` (the partial derivative is a number), `fixed` and `tunable` (it
depends on parameters only), `dependent` (anything else).
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmus.packaging.plant.expressions import PlantExpressions
from fmus.packaging.variables import ModelStructure, Unknown


def model_structure(expressions: PlantExpressions) -> ModelStructure:
    """Exact dependencies of outputs and derivatives on states, inputs and (initially) parameters.

    An output that is a state depends on nothing and is no initial unknown: its value is set.
    """
    interface = expressions.interface
    plant, references = interface.plant, interface.value_references
    derivatives = [interface.derivative_reference(state) for state in plant.states]
    rows = [*derivatives, *(references[output.name] for output in interface.outputs)]
    in_run = _dependencies(expressions, rows, initially=False)
    initial = _dependencies(expressions, rows, initially=True)
    outputs = tuple(
        Unknown(references[output.name], (), ())
        if output.name in interface.state_outputs
        else in_run[references[output.name]]
        for output in plant.outputs
    )
    return ModelStructure(
        outputs,
        tuple(in_run[reference] for reference in derivatives),
        tuple(initial[reference] for reference in sorted(initial)),
    )


def _dependencies(
    expressions: PlantExpressions, rows: list[int], *, initially: bool
) -> dict[int, Unknown]:
    interface = expressions.interface
    plant, references = interface.plant, interface.value_references
    knowns = [state.name for state in plant.states]
    knowns += [variable.name for variable in plant.inputs]
    knowns += [parameter.name for parameter in plant.parameters]
    n_columns = len(plant.states) + len(plant.inputs) + (len(plant.parameters) if initially else 0)
    found: dict[int, list[tuple[int, str]]] = {reference: [] for reference in rows}
    jacobian = expressions.jacobian
    starts, row_of = jacobian.sparsity().colind(), jacobian.sparsity().row()
    for column in range(n_columns):
        for k in range(starts[column], starts[column + 1]):
            kind = _kind(expressions, jacobian.nz[k], initially)
            found[rows[row_of[k]]].append((references[knowns[column]], kind))
    return {
        reference: Unknown(
            reference, tuple(r for r, _ in sorted(pairs)), tuple(k for _, k in sorted(pairs))
        )
        for reference, pairs in found.items()
    }


def _kind(expressions: PlantExpressions, derivative: Any, initially: bool) -> str:
    if ca.SX(derivative).is_constant():
        return "constant"
    if initially or ca.depends_on(derivative, ca.vertcat(expressions.x, expressions.u)):
        return "dependent"
    used = {symbol.name() for symbol in ca.symvar(derivative)}
    parameters = expressions.interface.plant.parameters
    return "tunable" if any(p.tunable for p in parameters if p.name in used) else "fixed"
