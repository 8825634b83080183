"""The portable FMU of a block: FMI 2 co-simulation through pythonfmu, no compiler needed.

It needs a Python with numpy on the importing machine. The step comes as Python text (a module
that defines `step(p, x, u, y)`), everything else is the runtime in `portable_parts`. Names,
value references and timing are those of the native FMU.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from fmus.packaging.archive import content_hash, content_token
from fmus.packaging.blocks.build import ExtraFiles, extra_name, write_with_extra
from fmus.packaging.blocks.description import block_description
from fmus.packaging.blocks.interface import BlockModel, block_entries
from fmus.packaging.cache import place, write_atomically
from fmus.packaging.portable import PARTS as PLANT_PARTS
from fmus.packaging.portable import pythonfmu_files

PARTS = Path(__file__).parent / "portable_parts"
_UNKNOWN_TOKEN = "{00000000-0000-0000-0000-000000000000}"
_SCRIPT = '''"""{name}: the module that pythonfmu loads."""

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from {package}.exit_order import release_python_before_exit
from {package}.instance import Instance, StepError
from {package}.tables import MODEL


class {name}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self._instance = Instance(MODEL)
        release_python_before_exit(self.resources)

    def setup_experiment(self, start_time, stop_time, tolerance):
        self._instance.setup_experiment(start_time)

    def exit_initialization_mode(self):
        self._instance.exit_initialization_mode()

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


def cached_portable_block(model: BlockModel, extra: ExtraFiles | None = None) -> Path:
    """Path of the portable FMU of `model` in the cache, whose `step` is Python text; built when it
    is not there yet, with the files that `extra` adds. Raises PackagingError when it cannot be."""
    files = portable_block_files(model)
    path = place(model.name, content_hash(files), f"portable block {extra_name(extra)}")
    if not path.exists():
        write_atomically(path, partial(write_with_extra, files, model.name, extra))
    return path


def portable_block_files(model: BlockModel) -> dict[str, bytes]:
    """All files of the FMU by path in the archive."""
    bundled = pythonfmu_files(model.name)

    def generate(token: str) -> dict[str, bytes]:
        return {
            "modelDescription.xml": block_description(model, 2, token, portable=True),
            **_resources(model, token),
        }

    token = content_token({**generate(_UNKNOWN_TOKEN), **bundled})
    return {**generate(token), **bundled}


def _resources(model: BlockModel, token: str) -> dict[str, bytes]:
    module = f"{model.name}_{token.strip('{}').replace('-', '')}"
    package = f"{module}_parts"
    script = _SCRIPT.format(name=model.name, package=package)
    parts = {part.name: part.read_bytes() for part in sorted(PARTS.glob("*.py"))}
    parts["exit_order.py"] = (PLANT_PARTS / "exit_order.py").read_bytes()
    parts["step.py"] = model.step.encode()
    parts["tables.py"] = _tables(model).encode()
    return {
        "resources/slavemodule.txt": module.encode(),
        f"resources/{module}.py": script.encode(),
        **{f"resources/{package}/{part}": text for part, text in parts.items()},
    }


def _tables(model: BlockModel) -> str:
    groups = (model.inputs, model.outputs, model.parameters, model.states)
    names = tuple(entry.name for entry in block_entries(model))[1:]
    start = ", ".join(_number(variable.start) for group in groups for variable in group)
    tunable = tuple(variable.tunable for variable in model.parameters)
    return (
        f'"""{model.name}: generated from the block\'s interface."""\n\n'
        "from .instance import Model\n"
        "from .step import step\n\n"
        "MODEL = Model(\n"
        f"    sizes={tuple(map(len, groups))!r},\n"
        f"    names={names!r},\n"
        f"    start=({start}{',' if names else ''}),\n"
        f"    tunable={tunable!r},\n"
        f"    sample_time={model.sample_time_ns},\n"
        f"    phase={model.phase_ns},\n"
        "    step=step,\n"
        ")\n"
    )


def _number(value: float) -> str:
    text = repr(float(value))
    return text if text[-1].isdigit() else f'float("{text}")'
