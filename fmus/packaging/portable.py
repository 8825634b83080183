"""The portable FMU: FMI 2 co-simulation through pythonfmu, for machines without a C compiler.

It needs a Python on the importing machine and nothing else: equations and solver are plain Python
(`portable_parts`), the small library that starts Python comes ready in pythonfmu's wheel, and
pythonfmu itself is bundled. All bundled modules of ours sit in a package whose name contains the
FMU's token, because FMUs in one process share modules of the same name. pythonfmu's builder is not
used: its archives differ from build to build and leave out units and dependencies.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

from fmus.packaging.archive import content_token, write_archive
from fmus.packaging.codegen import equations_of
from fmus.packaging.documentation import documentation_page
from fmus.packaging.emit import PYTHON, statements
from fmus.packaging.errors import PackagingError
from fmus.packaging.expressions import PlantExpressions, plant_expressions
from fmus.packaging.interface import RELATIVE_TOLERANCE
from fmus.packaging.model_description import model_description
from fmus.packaging.structure import model_structure
from fmus.plant import Plant

PARTS = Path(__file__).parent / "portable_parts"
_UNKNOWN_TOKEN = "{00000000-0000-0000-0000-000000000000}"
_SCRIPT = '''"""{name}: the module that pythonfmu loads."""

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from {package}.equations import MODEL
from {package}.exit_order import release_python_before_exit
from {package}.instance import Instance, StepError


class {name}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self._instance = Instance(MODEL)
        release_python_before_exit(self.resources)

    def setup_experiment(self, start_time, stop_time, tolerance):
        self._instance.setup_experiment(start_time, stop_time, tolerance)

    def do_step(self, current_time, step_size):
        try:
            self._instance.do_step(current_time, step_size)
        except StepError as failure:
            self.log(str(failure), Fmi2Status.error)
            return False
        return True

    def get_real(self, vrs):
        return self._instance.get_real(vrs)

    def set_real(self, vrs, values):
        self._instance.set_real(vrs, values)

    def _get_fmu_state(self):
        return self._instance.get_state()

    def _set_fmu_state(self, state):
        self._instance.set_state(state)
'''


@dataclass(frozen=True)
class PortableContent:
    """All files of a portable FMU by path in the archive, and its token."""

    token: str
    files: dict[str, bytes]


def portable_content(plant: Plant) -> PortableContent:
    """Generate the FMU; raises PackagingError when the plant is not sound or pythonfmu lacks."""
    expressions = plant_expressions(plant)
    structure = model_structure(expressions)

    def generate(token: str) -> dict[str, bytes]:
        description = model_description(expressions.interface, structure, 2, token, portable=True)
        return {
            "modelDescription.xml": description,
            "documentation/_main.html": documentation_page(plant),
            **_resources(expressions, token),
        }

    bundled = pythonfmu_files(plant.name)
    token = content_token({**generate(_UNKNOWN_TOKEN), **bundled})
    return PortableContent(token, {**generate(token), **bundled})


def write_portable_fmu(content: PortableContent, path: Path) -> None:
    """Write the archive to `path`."""
    write_archive(content.files, path)


def _resources(expressions: PlantExpressions, token: str) -> dict[str, bytes]:
    name = expressions.interface.plant.name
    module = f"{name}_{token.strip('{}').replace('-', '')}"
    package = f"{module}_parts"
    script = _SCRIPT.format(name=name, package=package)
    parts = {part.name: part.read_bytes() for part in sorted(PARTS.glob("*.py"))}
    parts["equations.py"] = equations_source(expressions).encode()
    return {
        "resources/slavemodule.txt": module.encode(),
        f"resources/{module}.py": script.encode(),
        **{f"resources/{package}/{part}": text for part, text in parts.items()},
    }


def equations_source(expressions: PlantExpressions) -> str:
    """Equations and tables of a plant as a Python module."""
    plant = expressions.interface.plant
    equations = equations_of(expressions)
    n_x, n_y = len(plant.states), len(expressions.interface.outputs)
    bounds = [
        (
            float("-inf") if p.minimum is None else float(p.minimum),
            float("inf") if p.maximum is None else float(p.maximum),
        )
        for p in plant.parameters
    ]
    tables = {
        "state_names": [state.name for state in plant.states],
        "x_start": [float(state.start) for state in plant.states],
        "x_nominal": [float(state.nominal) for state in plant.states],
        "u_start": [float(variable.start) for variable in plant.inputs],
        "p_start": [float(parameter.value) for parameter in plant.parameters],
        "p_range": bounds,
        "n_outputs": n_y,
        "relative_tolerance": RELATIVE_TOLERANCE,
    }
    lines = [
        f"    {name}={tuple(value) if isinstance(value, list) else value!r},"
        for name, value in tables.items()
    ]
    functions = ("derivatives", "outputs", "linearise")
    return "\n".join(
        (
            f'"""{plant.name}: generated from the plant\'s equations."""\n',
            "from .mathematics import *",
            "from .model import Model\n",
            _function(equations.derivatives, "derivatives", {"dx": n_x}),
            _function(equations.outputs, "outputs", {"y": n_y}),
            _function(equations.linearise, "linearise", {"dx": n_x, "jacobian": n_x * n_x}),
            "\nMODEL = Model(",
            *lines,
            *(f"    {name}={name}," for name in functions),
            ")\n",
        )
    )


def _function(function: Any, name: str, results: dict[str, int]) -> str:
    head = [f"    {result} = [0.0] * {size}" for result, size in results.items()]
    body = statements(function, PYTHON, ["x", "u", "p"], list(results))
    lines = [f"\ndef {name}(x, u, p):", *head, body, f"    return {', '.join(results)}\n"]
    return "\n".join(line for line in lines if line)


def pythonfmu_files(name: str) -> dict[str, bytes]:
    """pythonfmu's Python files, its libraries under the FMU's name, and its licence."""
    # Not `import pythonfmu`: a portable FMU loaded into this process may have put its own first.
    wheel = distribution("pythonfmu")
    root = Path(str(wheel.locate_file("pythonfmu")))
    files = {f"resources/pythonfmu/{path.name}": path for path in root.glob("*.py")}
    binaries = root / "resources" / "binaries"
    for library in binaries.rglob("*"):
        if library.suffix in (".so", ".dll", ".dylib"):
            files[f"binaries/{library.parent.name}/{name}{library.suffix}"] = library
    if not any(path.startswith("binaries/") for path in files):
        raise PackagingError(
            f"The installed pythonfmu ({root}) brings no libraries; install its wheel from PyPI."
        )
    for path in wheel.files or ():
        if path.name.upper().startswith("LICENSE"):
            files["documentation/licenses/pythonfmu.txt"] = Path(str(path.locate()))
    return {place: path.read_bytes() for place, path in files.items()}
