"""The bridges from FMI to Python: pythonfmu for FMI 2, pythonfmu3 for FMI 3.

Each comes as a wheel with a small library that starts Python, for the platforms that its authors
build for, and with the Python files that the library talks to. Both are bundled into a portable
FMU. The modules that they load differ in names only.

Nothing of a bridge is imported here: a portable FMU loaded into this process may have put its own
first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from fmus.packaging.errors import PackagingError

SHARED_PARTS = Path(__file__).parent / "portable_parts"
PYTHON_NEEDED = "Python 3.9 or newer, 64 bit, with its shared library"
LIBRARIES = (".so", ".dll", ".dylib")


@dataclass(frozen=True)
class Bridge:
    """A bridge and what it calls things; a step that `failed` returns that, Discard in FMI 2 (its
    library knows no other) and Error in FMI 3; `extra` is the extra that installs it."""

    package: str
    version: int
    number: str
    experiment: str
    failed: str
    extra: str = ""


BRIDGES = {
    2: Bridge("pythonfmu", 2, "real", "start_time, stop_time, tolerance", "False"),
    3: Bridge(
        "pythonfmu3",
        3,
        "float64",
        "start_time",
        "pythonfmu3.Fmi3StepResult(Fmi3Status.error)",
        "portable3",
    ),  # fmt: skip,
}

_SCRIPT = '''"""{name}: the module that {bridge} loads."""

import {bridge}
from {bridge}.enums import Fmi{version}Status

from {package}.exit_order import release_python_before_exit
from {package}.guard import Guard, state_from_bytes, state_to_bytes
from {package}.instance import Instance
from {package}.tables import MODEL


class {name}({bridge}.Fmi{version}Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self._guard = Guard(Instance(MODEL), lambda text: self.log(text, Fmi{version}Status.error))
        release_python_before_exit(self.resources)

    def setup_experiment(self, {experiment}):
        self._guard.setup_experiment({experiment})

    def enter_initialization_mode(self):
        self._guard.enter_initialization_mode()

    def exit_initialization_mode(self):
        self._guard.exit_initialization_mode()

    def terminate(self):
        self._guard.terminate()

    def do_step(self, current_time, step_size):
        return self._guard.do_step(current_time, step_size) or {failed}

    def get_{number}(self, vrs):
        return self._guard.get_real(vrs)

    def set_{number}(self, vrs, values):
        self._guard.set_real(vrs, values)

    def _get_fmu_state(self):
        return self._guard.get_state()

    def _set_fmu_state(self, state):
        self._guard.set_state(state)

    @staticmethod
    def _fmu_state_to_bytes(state):
        return state_to_bytes(state, "{package}")

    @staticmethod
    def _fmu_state_from_bytes(data):
        return state_from_bytes(data, "{package}")
'''


def bundled_parts(
    name: str, fmi_version: int, token: str, parts: Path, generated: Mapping[str, str]
) -> dict[str, bytes]:
    """The folder `resources` of a portable FMU but the bridge itself, by path in the archive.

    The FMU's own modules are those of the folder `parts`, those that all share, and the text of
    `generated` by name, which holds the model in `tables`. They sit in a package whose name holds
    the FMU's token, as FMUs in one process share modules of the same name.
    """
    bridge = BRIDGES[fmi_version]
    module = f"{name}_{token.strip('{}').replace('-', '')}"
    package = f"{module}_parts"
    script = _SCRIPT.format(
        name=name, bridge=bridge.package, version=bridge.version, number=bridge.number,
        experiment=bridge.experiment, failed=bridge.failed, package=package,
    )  # fmt: skip
    files = [path for folder in (SHARED_PARTS, parts) for path in sorted(folder.glob("*.py"))]
    texts = {path.name: path.read_bytes() for path in files}
    texts |= {f"{name}.py": text.encode() for name, text in generated.items()}
    return {
        "resources/slavemodule.txt": module.encode(),
        f"resources/{module}.py": script.encode(),
        **{f"resources/{package}/{name}": text for name, text in texts.items()},
    }


def bridge_files(name: str, fmi_version: int) -> dict[str, bytes]:
    """A bridge's Python files, its libraries under the FMU's name, and its licence.

    Raises PackagingError where the bridge is not installed or brings no libraries.
    """
    bridge = BRIDGES[fmi_version]
    try:
        wheel = distribution(bridge.package)
    except PackageNotFoundError:
        way = f"pip install fmu-harness[{bridge.extra}]" if bridge.extra else "install it"
        raise PackagingError(
            f"A portable FMU of FMI {fmi_version} needs {bridge.package}, which is not installed; "
            f"{way}, or choose fmi_version=2."
        ) from None
    root = Path(str(wheel.locate_file(bridge.package)))
    files = {f"resources/{bridge.package}/{path.name}": path for path in root.glob("*.py")}
    for library in (root / "resources" / "binaries").rglob("*"):
        if library.suffix in LIBRARIES:
            files[f"binaries/{library.parent.name}/{name}{library.suffix}"] = library
    if not any(path.startswith("binaries/") for path in files):
        raise PackagingError(
            f"The installed {bridge.package} ({root}) brings no libraries; install its wheel from "
            "PyPI."
        )
    for path in wheel.files or ():
        if path.name.upper().startswith("LICENSE"):
            files[f"documentation/licenses/{bridge.package}.txt"] = Path(str(path.locate()))
    return {place: path.read_bytes() for place, path in files.items()}
