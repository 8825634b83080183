"""The FMU of a block on disk: built on first use, found again by what it is made of.

There is no folder `sources`: the step is no C. What the binaries were made from, C files and the
LLVM module, lies in `extra/fmu-harness.build/`; clang compiles it again for any other platform.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from fmus.packaging.archive import UNKNOWN_TOKEN, compiled_binaries, content_hash, content_token
from fmus.packaging.block.description import block_description
from fmus.packaging.block.extra import ExtraFiles, extra_name, write_with_extra
from fmus.packaging.block.interface import BlockModel
from fmus.packaging.block.page import block_documents
from fmus.packaging.block.sources import block_source_files
from fmus.packaging.cache import made_by, place, write_atomically
from fmus.packaging.compiler import Target, find_targets
from fmus.packaging.errors import PackagingError

BUILD_FOLDER = "extra/fmu-harness.build"


def cached_block_fmu(
    model: BlockModel,
    fmi_version: int = 3,
    *,
    targets: Sequence[str] = (),
    extra: ExtraFiles | None = None,
) -> Path:
    """Path of the block's FMU in the cache, built when it is not there yet.

    `targets` are platforms, see `find_targets`. `extra` gets the path of the FMU without extra
    files and returns what to add, by path below `extra/`; it is asked once, when the FMU is built.
    Raises PackagingError when the FMU cannot be built.
    """
    if fmi_version not in (2, 3):
        raise PackagingError(f"FMI version {fmi_version!r} is not made; choose 2 or 3.")
    found = find_targets(targets)
    files = block_files(model, fmi_version)
    path = place(model.name, content_hash(files), f"{made_by(found)} {extra_name(extra)}")
    if not path.exists():
        write_atomically(path, partial(_write, model, fmi_version, files, found, extra))
    return path


def block_files(model: BlockModel, fmi_version: int) -> dict[str, bytes]:
    """Everything in the FMU but binaries and extra files, by path in the archive."""

    papers = block_documents(model, fmi_version)

    def generate(token: str) -> dict[str, bytes]:
        made_from = block_source_files(model, fmi_version, token) | {"step.ll": model.step.encode()}
        return {
            "modelDescription.xml": block_description(model, fmi_version, token),
            **papers,
            **{f"{BUILD_FOLDER}/{name}": data for name, data in made_from.items()},
        }

    return generate(content_token(generate(UNKNOWN_TOKEN)))


def _write(
    model: BlockModel,
    fmi_version: int,
    files: dict[str, bytes],
    targets: Sequence[Target],
    extra: ExtraFiles | None,
    path: Path,
) -> None:
    from fmus.packaging.block.objects import object_code  # LLVM, which a cached FMU does not need

    sources = {
        name.removeprefix(f"{BUILD_FOLDER}/"): data
        for name, data in files.items()
        if name.startswith(BUILD_FOLDER) and not name.endswith(".ll")
    }
    object_for = partial(object_code, model.step)
    binaries = compiled_binaries(model.name, fmi_version, sources, targets, object_for)
    write_with_extra({**files, **binaries}, model.name, extra, path)
