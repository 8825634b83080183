"""The FMU of a block on disk: built on first use, found again by what it is made of.

There is no folder `sources`: the step is no C. What the binaries were made from, C files and the
LLVM module, lies in `extra/fmu-harness.build/`; clang compiles it again for any other platform.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Protocol

from fmus.packaging.archive import compiled_binaries, content_hash, content_token, write_archive
from fmus.packaging.blocks.description import block_description
from fmus.packaging.blocks.interface import BlockModel, BlockVariable, numbered
from fmus.packaging.blocks.sources import block_source_files
from fmus.packaging.cache import cache_directory, made_by, place, write_atomically
from fmus.packaging.compiler import Target, find_targets
from fmus.packaging.errors import PackagingError

_UNKNOWN_TOKEN = "{00000000-0000-0000-0000-000000000000}"
BUILD_FOLDER = "extra/fmu-harness.build"


class Signal(Protocol):
    """An input or output as controllers describe it."""

    @property
    def name(self) -> str:
        """Unique in the block."""

    @property
    def unit(self) -> str:
        """Such as "N"; "" where it is not stated."""

    @property
    def description(self) -> str:
        """One line for people."""

    @property
    def start(self) -> float:
        """The value before the block has run for the first time."""


ExtraFiles = Callable[[Path], Mapping[str, bytes]]


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
    path = place(model.name, content_hash(files), f"{made_by(found)} {_name(extra)}")
    if not path.exists():
        write_atomically(path, partial(_write, model, fmi_version, files, found, extra))
    return path


def package_block(
    step: Callable[[], str],
    *,
    step_key: str,
    name: str,
    description: str,
    sample_time_ns: int,
    inputs: Sequence[Signal],
    outputs: Sequence[Signal],
    parameters: Sequence[float],
    state: Sequence[float],
    parameter_names: Sequence[str] = (),
    state_names: Sequence[str] = (),
    tunable: Sequence[str] = (),
    phase_ns: int = 0,
    fmi_version: int = 3,
    targets: Sequence[str] = (),
    extra: ExtraFiles | None = None,
) -> Path:
    """`cached_block_fmu` for a block as whoever compiles its `step` has it: signals with name,
    unit, description and start, values as arrays, names where there are any. `step()` gives the
    LLVM module and is called unless it is known under `step_key`, which must change with it. This
    is what the entry-point group `fmu_harness.packagers` offers as "native"."""
    p_names = numbered("parameters", parameter_names, len(parameters))
    x_names = numbered("state", state_names, len(state))
    can_tune = [name in tunable for name in parameter_names] or [False] * len(parameters)
    model = BlockModel(
        name,
        description,
        sample_time_ns,
        tuple(BlockVariable(s.name, s.start, s.unit, s.description) for s in inputs),
        tuple(BlockVariable(s.name, s.start, s.unit, s.description) for s in outputs),
        tuple(
            BlockVariable(n, float(value), tunable=free)
            for n, value, free in zip(p_names, parameters, can_tune, strict=True)
        ),
        tuple(BlockVariable(n, float(value)) for n, value in zip(x_names, state, strict=True)),
        _known_step(step, step_key),
        phase_ns,
    )
    return cached_block_fmu(model, fmi_version, targets=targets, extra=extra)


def block_files(model: BlockModel, fmi_version: int) -> dict[str, bytes]:
    """Everything in the FMU but binaries and extra files, by path in the archive."""

    def generate(token: str) -> dict[str, bytes]:
        made_from = block_source_files(model, fmi_version, token) | {"step.ll": model.step.encode()}
        return {
            "modelDescription.xml": block_description(model, fmi_version, token),
            **{f"{BUILD_FOLDER}/{name}": data for name, data in made_from.items()},
        }

    return generate(content_token(generate(_UNKNOWN_TOKEN)))


def _known_step(step: Callable[[], str], key: str) -> str:
    """The module from the cache; making it can take seconds."""
    path = cache_directory() / "steps" / f"{key}.ll"
    if not path.exists():
        text = step()
        write_atomically(path, lambda part: part.write_bytes(text.encode()))
    return path.read_bytes().decode()


def _name(extra: ExtraFiles | None) -> str:
    return "" if extra is None else f"{extra.__module__}.{extra.__qualname__}"


def _write(
    model: BlockModel,
    fmi_version: int,
    files: dict[str, bytes],
    targets: Sequence[Target],
    extra: ExtraFiles | None,
    path: Path,
) -> None:
    from fmus.packaging.blocks.objects import object_code  # LLVM, which a cached FMU does not need

    sources = {
        name.removeprefix(f"{BUILD_FOLDER}/"): data
        for name, data in files.items()
        if name.startswith(BUILD_FOLDER) and not name.endswith(".ll")
    }
    object_for = partial(object_code, model.step)
    binaries = compiled_binaries(model.name, fmi_version, sources, targets, object_for)
    complete = {**files, **binaries}
    if extra is not None:
        with tempfile.TemporaryDirectory(prefix="fmu-harness-") as folder:
            plain = Path(folder, f"{model.name}.fmu")
            write_archive(complete, plain)
            complete |= {f"extra/{name}": data for name, data in extra(plain).items()}
    write_archive(complete, path)
