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
from fmus.packaging.plant.elimination import elimination
from fmus.packaging.plant.emit import C, statements
from fmus.packaging.plant.expressions import PlantExpressions
from fmus.packaging.plant.instructions import Body, body_of, with_reciprocals, without_invariants
from fmus.packaging.plant.interface import RELATIVE_TOLERANCE

RUNTIME = Path(__file__).parent / "c"
INVARIANT = frozenset({"u", "p"})


@dataclass(frozen=True)
class Routine:
    """A generated function: arrays it reads, arrays it fills with their sizes, and its body."""

    arguments: tuple[str, ...]
    results: dict[str, int]
    body: Body


@dataclass(frozen=True, eq=False)
class Equations:
    """What an FMU evaluates, in either language: routines by name, and the patterns of Jacobians.

    `invariants` computes from (u, p) what derivatives and linearise read besides x; `linearise`
    yields dx and the nonzeros of df/dx by columns, whose rows are `state_rows`; `factorise` and
    `solve` are those of `elimination`. `jacobian` yields the nonzeros of d(f, h)/d(x, u, p), whose
    compressed columns are `starts` and `rows`.
    """

    routines: dict[str, Routine]
    state_rows: tuple[int, ...]
    starts: tuple[int, ...]
    rows: tuple[int, ...]

    def size(self, routine: str, result: str) -> int:
        """How many numbers a result of a routine has."""
        return self.routines[routine].results[result]


def equations_of(expressions: PlantExpressions) -> Equations:
    """The functions that an FMU evaluates."""
    symbols, dx = [expressions.x, expressions.u, expressions.p], expressions.dx
    jacobian = expressions.jacobian
    state_jacobian = ca.sparsify(ca.jacobian(dx, expressions.x))
    solver = elimination(state_jacobian.sparsity())

    def body(results: dict[str, Any]) -> Body:
        function = ca.Function("f", symbols, list(results.values()), {"cse": True})
        return body_of(function, "xup", list(results))

    def routine(arguments: Sequence[str], results: dict[str, Any], body: Body) -> Routine:
        return Routine(tuple(arguments), {k: v.nnz() for k, v in results.items()}, body)

    rates = {"dx": dx}, {"dx": dx, "state_jacobian": state_jacobian}
    computed, bodies = without_invariants([body(r) for r in rates], INVARIANT, "invariants")
    n_invariants = sum(one.code == ca.OP_OUTPUT for one in computed)
    x_to = ("x", "u", "p", "invariants")
    factorise, solve = ("state_jacobian", "diagonal"), ("factors", "right")
    return Equations(
        {
            "invariants": Routine(("u", "p"), {"invariants": n_invariants}, computed),
            "derivatives": routine(x_to, rates[0], bodies[0]),
            "linearise": routine(x_to, rates[1], bodies[1]),
            **{
                name: routine("xup", results, with_reciprocals(body(results)))
                for name, results in (
                    ("outputs", {"y": expressions.y}),
                    ("jacobian", {"nonzeros": jacobian}),
                )
            },
            "factorise": Routine(
                factorise,
                {"factors": solver.n_factors},
                with_reciprocals(body_of(solver.factorise, factorise, ["factors"])),
            ),
            "solve": Routine(
                solve,
                {"solution": dx.nnz()},
                with_reciprocals(body_of(solver.solve, solve, ["solution"])),
            ),
        },
        tuple(state_jacobian.sparsity().row()),
        tuple(jacobian.sparsity().colind()),
        tuple(jacobian.sparsity().row()),
    )


def model_source(expressions: PlantExpressions, fmi_version: int, token: str) -> str:
    """The text of `model.c`."""
    equations = equations_of(expressions)
    return "\n".join(
        (
            f"/* {expressions.interface.plant.name}: generated from the plant's equations. */\n",
            "#include <math.h>\n",
            _definitions(expressions, equations, fmi_version, token),
            _tables(expressions, equations),
            *(_function(name, one) for name, one in equations.routines.items()),
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
        "N_FACTORS": equations.size("factorise", "factors"),
        "N_INVARIANTS": equations.size("invariants", "invariants"),
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


def _function(name: str, routine: Routine) -> str:
    signature = [f"const double *restrict {argument}" for argument in routine.arguments]
    signature += [f"double *restrict {result}" for result in routine.results]
    unused = "".join(f"    (void){name};\n" for name in (*routine.arguments, *routine.results))
    body = statements(routine.body, C)
    return f"static void model_{name}({', '.join(signature)}) {{\n{unused}{body}\n}}\n"
