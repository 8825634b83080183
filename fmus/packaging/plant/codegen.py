"""The generated half of an FMU's C sources: `model.c`, tables and equations of one plant.

The other half, the runtime in `c/`, is the same for all plants. What `model.c` must define is
written at the head of `c/component.h`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca

from fmus.packaging.c_source import c_numbers, c_table, runtime_files
from fmus.packaging.plant.elimination import Elimination, elimination
from fmus.packaging.plant.emit import C, statements
from fmus.packaging.plant.expressions import PlantExpressions
from fmus.packaging.plant.interface import RELATIVE_TOLERANCE

RUNTIME = Path(__file__).parent / "c"
FACTORISE = ("state_jacobian", "diagonal")
SOLVE = ("factors", "right")


@dataclass(frozen=True, eq=False)
class Equations:
    """CasADi functions of (x, u, p) from which both languages are written.

    `linearise` yields dx and the nonzeros of df/dx by columns, whose rows are `state_rows`;
    `elimination` solves with d·I − df/dx. `jacobian` yields the nonzeros of d(f, h)/d(x, u, p),
    whose compressed columns are `starts` and `rows`.
    """

    derivatives: Any
    outputs: Any
    linearise: Any
    state_rows: tuple[int, ...]
    elimination: Elimination
    jacobian: Any
    starts: tuple[int, ...]
    rows: tuple[int, ...]


def equations_of(expressions: PlantExpressions) -> Equations:
    """The functions that an FMU evaluates."""
    arguments = [expressions.x, expressions.u, expressions.p]
    jacobian = expressions.jacobian
    state_jacobian = ca.sparsify(ca.jacobian(expressions.dx, expressions.x))
    pattern = state_jacobian.sparsity()

    def function(name: str, *results: Any) -> Any:
        return ca.Function(name, arguments, list(results), {"cse": True})

    return Equations(
        function("derivatives", expressions.dx),
        function("outputs", expressions.y),
        function("linearise", expressions.dx, state_jacobian),
        tuple(pattern.row()),
        elimination(pattern),
        function("jacobian", jacobian),
        tuple(jacobian.sparsity().colind()),
        tuple(jacobian.sparsity().row()),
    )


def model_source(expressions: PlantExpressions, fmi_version: int, token: str) -> str:
    """The text of `model.c`."""
    equations = equations_of(expressions)
    solver = equations.elimination
    return "\n".join(
        (
            f"/* {expressions.interface.plant.name}: generated from the plant's equations. */\n",
            "#include <math.h>\n",
            _definitions(expressions, equations, fmi_version, token),
            _tables(expressions, equations),
            _function(equations.derivatives, "model_derivatives", "xup", ["dx"]),
            _function(equations.outputs, "model_outputs", "xup", ["y"]),
            _function(equations.linearise, "model_linearise", "xup", ["dx", "state_jacobian"]),
            _function(equations.jacobian, "model_jacobian", "xup", ["nonzeros"]),
            _function(solver.factorise, "model_factorise", FACTORISE, ["factors"]),
            _function(solver.solve, "model_solve", SOLVE, ["solution"]),
        )
    )


def source_files(expressions: PlantExpressions, fmi_version: int, token: str) -> dict[str, bytes]:
    """All files of the folder `sources`, by name."""
    files = runtime_files(RUNTIME, fmi_version)
    files["model.c"] = model_source(expressions, fmi_version, token).encode()
    return files


def _definitions(
    expressions: PlantExpressions, equations: Equations, fmi_version: int, token: str
) -> str:
    interface = expressions.interface
    values = {
        "FMI_VERSION": fmi_version,
        "MODEL_IDENTIFIER": interface.plant.name,
        "MODEL_TOKEN": f'"{token}"',
        "MODEL_TOLERANCE": RELATIVE_TOLERANCE,
        "N_X": len(interface.plant.states),
        "N_U": len(interface.plant.inputs),
        "N_Y": len(interface.outputs),
        "N_P": len(interface.plant.parameters),
        "N_JACOBIAN": len(equations.rows),
        "N_STATE_JACOBIAN": len(equations.state_rows),
        "N_FACTORS": equations.elimination.n_factors,
    }
    return "".join(f"#define {name} {value}\n" for name, value in values.items())


def _tables(expressions: PlantExpressions, equations: Equations) -> str:
    plant = expressions.interface.plant
    parameters = plant.parameters
    names = [f'"{name}"' for name in expressions.interface.names]
    minima = [float("-inf") if p.minimum is None else p.minimum for p in parameters]
    maxima = [float("inf") if p.maximum is None else p.maximum for p in parameters]
    tables = (
        ("char *const", "model_names", names),
        ("double", "model_x_start", c_numbers(s.start for s in plant.states)),
        ("double", "model_x_nominal", c_numbers(s.nominal for s in plant.states)),
        ("double", "model_u_start", c_numbers(v.start for v in plant.inputs)),
        ("double", "model_p_start", c_numbers(p.value for p in parameters)),
        ("double", "model_p_minimum", c_numbers(minima)),
        ("double", "model_p_maximum", c_numbers(maxima)),
        ("int", "model_p_tunable", [str(int(p.tunable)) for p in parameters]),
        ("int", "model_jacobian_starts", [str(i) for i in equations.starts]),
        ("int", "model_jacobian_rows", [str(i) for i in equations.rows]),
        ("int", "model_state_jacobian_rows", [str(i) for i in equations.state_rows]),
    )
    return "".join(c_table(kind, name, entries) for kind, name, entries in tables)


def _function(function: Any, name: str, arguments: Sequence[str], results: list[str]) -> str:
    signature = [f"const double *restrict {argument}" for argument in arguments]
    signature += [f"double *restrict {result}" for result in results]
    unused = "".join(f"    (void){letter};\n" for letter in (*arguments, *results))
    body = statements(function, C, list(arguments), results)
    return f"static void {name}({', '.join(signature)}) {{\n{unused}{body}\n}}\n"
