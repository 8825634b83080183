"""The portable FMU of a block: co-simulation through Python, no compiler needed.

It needs a Python with numpy on the importing machine. The step comes as Python text (a module
that defines `step(p, x, u, y)`), everything else is the runtime in `portable_parts`. Names,
value references and timing are those of the native FMU.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from fmus.packaging.archive import UNKNOWN_TOKEN, content_hash, content_token
from fmus.packaging.block.description import block_description
from fmus.packaging.block.extra import ExtraFiles, extra_name, write_with_extra
from fmus.packaging.block.interface import BlockModel, block_entries
from fmus.packaging.block.page import block_documents
from fmus.packaging.bridge import PYTHON_NEEDED, bridge_files, bundled_parts
from fmus.packaging.cache import place, write_atomically

PARTS = Path(__file__).parent / "portable_parts"


def cached_portable_block(
    model: BlockModel, fmi_version: int = 2, extra: ExtraFiles | None = None
) -> Path:
    """Path of the portable FMU of `model` in the cache, whose `step` is Python text; built when it
    is not there yet, with the files that `extra` adds. Raises PackagingError when it cannot be."""
    files = portable_block_files(model, fmi_version)
    path = place(model.name, content_hash(files), f"portable block {extra_name(extra)}")
    if not path.exists():
        write_atomically(path, partial(write_with_extra, files, model.name, extra))
    return path


def portable_block_files(model: BlockModel, fmi_version: int) -> dict[str, bytes]:
    """All files of the FMU by path in the archive."""
    bundled = bridge_files(model.name, fmi_version)
    needs = (PYTHON_NEEDED, "numpy 1.20 or newer")
    papers = block_documents(model, fmi_version, needs)
    generated = {"step": model.step, "tables": _tables(model)}

    def generate(token: str) -> dict[str, bytes]:
        return {
            "modelDescription.xml": block_description(model, fmi_version, token, portable=True),
            **papers,
            **bundled_parts(model.name, fmi_version, token, PARTS, generated),
        }

    token = content_token({**generate(UNKNOWN_TOKEN), **bundled})
    return {**generate(token), **bundled}


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
