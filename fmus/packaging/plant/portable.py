"""The portable FMU: co-simulation through pythonfmu or pythonfmu3, without a C compiler.

It needs a Python on the importing machine and nothing else: equations and solver are plain Python
(`portable_parts`), the small library that starts Python comes ready in pythonfmu's wheel, and
pythonfmu itself is bundled. All bundled modules of ours sit in a package whose name contains the
FMU's token, because FMUs in one process share modules of the same name. pythonfmu's builder is not
used: its archives differ from build to build and leave out units and dependencies.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from fmus.declaration import PlantModel
from fmus.packaging.archive import UNKNOWN_TOKEN, content_token, write_archive
from fmus.packaging.bridge import PYTHON_NEEDED, bridge_files, bundled_parts
from fmus.packaging.documentation import documents
from fmus.packaging.plant.codegen import Routine, equations_of
from fmus.packaging.plant.emit import PYTHON, statements
from fmus.packaging.plant.expressions import PlantExpressions, plant_expressions
from fmus.packaging.plant.interface import RELATIVE_TOLERANCE
from fmus.packaging.plant.model_description import model_description
from fmus.packaging.plant.page import plant_page
from fmus.packaging.plant.structure import model_structure

PARTS = Path(__file__).parent / "portable_parts"


@dataclass(frozen=True)
class PortableContent:
    """All files of a portable FMU by path in the archive, and its token."""

    token: str
    files: dict[str, bytes]


def portable_content(plant: PlantModel, fmi_version: int = 2) -> PortableContent:
    """Generate the FMU; raises PackagingError when the plant is not sound or the bridge lacks."""
    expressions = plant_expressions(plant)
    structure = model_structure(expressions)
    equations = equations_source(expressions)

    def generate(token: str) -> dict[str, bytes]:
        description = model_description(
            expressions.interface, structure, fmi_version, token, portable=True
        )
        return {
            "modelDescription.xml": description,
            **papers,
            **bundled_parts(plant.name, fmi_version, token, PARTS, {"tables": equations}),
        }

    bundled = bridge_files(plant.name, fmi_version)
    names = [[v.name for v in group] for group in (plant.inputs, plant.outputs)]
    papers = documents(plant_page(plant), fmi_version, *names, needs=(PYTHON_NEEDED,))
    token = content_token({**generate(UNKNOWN_TOKEN), **bundled})
    return PortableContent(token, {**generate(token), **bundled})


def write_portable_fmu(content: PortableContent, path: Path) -> None:
    """Write the archive to `path`."""
    write_archive(content.files, path)


def equations_source(expressions: PlantExpressions) -> str:
    """Equations and tables of a plant as a Python module."""
    plant = expressions.interface.plant
    equations = equations_of(expressions)
    bounds = [
        (
            float("-inf") if p.minimum is None else float(p.minimum),
            float("inf") if p.maximum is None else float(p.maximum),
        )
        for p in plant.parameters
    ]
    tables = {
        "names": list(expressions.interface.names),
        "state_names": [state.name for state in plant.states],
        "x_start": [float(state.start) for state in plant.states],
        "x_nominal": [float(state.nominal) for state in plant.states],
        "u_start": [float(variable.start) for variable in plant.inputs],
        "p_start": [float(parameter.value) for parameter in plant.parameters],
        "p_range": bounds,
        "p_tunable": [parameter.tunable for parameter in plant.parameters],
        "n_outputs": len(expressions.interface.outputs),
        "state_jacobian_rows": list(equations.state_rows),
        "relative_tolerance": RELATIVE_TOLERANCE,
    }
    lines = [
        f"    {name}={tuple(value) if isinstance(value, list) else value!r},"
        for name, value in tables.items()
    ]
    functions = ("invariants", "derivatives", "outputs", "linearise", "factorise", "solve")
    return "\n".join(
        (
            f'"""{plant.name}: generated from the plant\'s equations."""\n',
            "from .mathematics import *",
            "from .model import Model\n",
            *(_function(name, equations.routines[name]) for name in functions),
            "\nMODEL = Model(",
            *lines,
            *(f"    {name}={name}," for name in functions),
            ")\n",
        )
    )


def _function(name: str, routine: Routine) -> str:
    head = [f"    {result} = [0.0] * {size}" for result, size in routine.results.items()]
    body = statements(routine.body, PYTHON)
    lines = [f"\ndef {name}({', '.join(routine.arguments)}):", *head, body]
    return "\n".join(
        line for line in (*lines, f"    return {', '.join(routine.results)}\n") if line
    )
