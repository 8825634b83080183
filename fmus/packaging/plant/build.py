"""The FMU of a plant from the cache, built on first use.

Generating the files just to learn the key takes some milliseconds and an import of CasADi. A note
beside the FMU spares that: it is filed under a hash of the plant's data and of every Python and C
file of the package that the equations come from. Equations that carry more than their source shows
(closures, defaults, lambdas) get no note; those that lean on a package other than their own,
CasADi and the standard library should not be changed there without emptying the cache.
"""

from __future__ import annotations

import hashlib
import inspect
import sys
import warnings
from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

from fmus.declaration import PlantModel
from fmus.packaging.archive import content_hash
from fmus.packaging.cache import cache_directory, kept, made_by, place, write_atomically
from fmus.packaging.compiler import Target, find_compiler, find_targets
from fmus.packaging.errors import CompilerError, PackagingError, PortableFallback


def cached_fmu(
    plant: PlantModel, fmi_version: int = 3, *, portable: bool = False, targets: Sequence[str] = ()
) -> Path:
    """Path of the plant's FMU in the cache, built when it is not there yet.

    `targets` are the platforms of its binaries, see `find_targets`; the running one when none is
    named. Without a C compiler that works the portable FMU (FMI 2, slower) takes the place of the
    native one and a `PortableFallback` warning says so. Raises PackagingError when it cannot be
    built.
    """
    if fmi_version not in (2, 3):
        raise PackagingError(f"FMI version {fmi_version!r} is not made; choose 2 or 3.")
    if not portable and (targets or find_compiler() is not None):
        found = find_targets(targets)
        kind = f"native {fmi_version} {made_by(found)}"
        try:
            return _noted(plant, kind, lambda: _build(plant, fmi_version, found))
        except CompilerError as fault:
            if targets:
                raise
            said = str(fault).strip().splitlines()
            _fall_back(plant, f"The C compiler failed ({said[-1].strip()[:300]})")
    elif not portable:
        _fall_back(plant, "No C compiler found")
    version = fmi_version if portable else 2
    return _noted(plant, f"portable {version}", lambda: _build(plant, version, ()))


def fmu_file(
    plant: PlantModel,
    fmi_version: int,
    directory: str | Path,
    *,
    portable: bool = False,
    targets: Sequence[str] = (),
) -> Path:
    """Write `<name>.fmu` into `directory` (made if missing) and return its path."""
    source = cached_fmu(plant, fmi_version, portable=portable, targets=targets)
    target = Path(directory) / f"{plant.name}.fmu"
    target.parent.mkdir(parents=True, exist_ok=True)
    data = source.read_bytes()
    write_atomically(target, lambda path: path.write_bytes(data))
    return target


def _fall_back(plant: PlantModel, reason: str) -> None:
    warnings.warn(
        f"{reason}: {plant.name!r} becomes a portable FMU, which needs Python where it "
        "runs, steps about thirty times slower and exists for FMI 2 co-simulation only; install a "
        "C compiler that works or `pip install fmu-harness[zig]` for the native one.",
        PortableFallback,
        stacklevel=3,
    )


def _build(plant: PlantModel, fmi_version: int, targets: Sequence[Target]) -> Path:
    """Generate, look the content up, and write it when it is new."""
    # CasADi comes with these imports; a noted FMU is found without it.
    from fmus.packaging.plant.native import native_content, write_native_fmu
    from fmus.packaging.plant.portable import portable_content, write_portable_fmu

    if not targets:
        portable = portable_content(plant, fmi_version)
        path = place(plant.name, content_hash(portable.files), "portable")
        if not path.exists():
            write_atomically(path, lambda part: write_portable_fmu(portable, part))
        return path
    native = native_content(plant, fmi_version)
    path = place(plant.name, content_hash(native.files), made_by(targets))
    if not path.exists():
        write_atomically(path, lambda part: write_native_fmu(native, targets, part))
    return path


def _noted(plant: PlantModel, kind: str, build: Callable[[], Path]) -> Path:
    """The path in the note of this plant and kind, else what `build` returns, noted."""
    fingerprint = _plant_fingerprint(plant)
    if fingerprint is None:
        return build()
    key = hashlib.sha256(f"{fingerprint} {kind}".encode()).hexdigest()[:32]
    note = kept(f"notes/{key}")
    if note.exists():
        path = kept(note.read_text("utf-8"))
        if path.exists():
            return path
    path = build()
    relative = "/".join(path.parts[-2:])
    write_atomically(
        cache_directory() / "notes" / key, lambda part: part.write_text(relative, "utf-8")
    )
    return path


def _plant_fingerprint(plant: PlantModel) -> str | None:
    """Hash of everything that decides the FMU, or None when it cannot be told from outside."""
    equations = plant.equations
    if not (inspect.isfunction(equations) and _is_plain(equations)):
        return None
    package, dot, _ = equations.__module__.partition(".")
    above = Path(inspect.getfile(equations)).resolve().parents
    root = next((folder for folder in above if folder.name == package), None)
    if root is None or not dot:
        return None
    data = [repr(getattr(plant, f.name)) for f in fields(plant) if f.name != "equations"]
    parts = [equations.__module__, equations.__qualname__, *data]
    parts += [version("casadi"), version("pythonfmu"), sys.version, _own_sources()]
    parts += [_source_hash(root)]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _is_plain(function: Callable[..., object]) -> bool:
    """A module-level function without closure or defaults, as its module's source shows it."""
    module = sys.modules.get(function.__module__)
    return (
        module is not None
        and getattr(module, function.__name__, None) is function
        and not getattr(function, "__closure__", None)
        and not getattr(function, "__defaults__", None)
        and not getattr(function, "__kwdefaults__", None)
    )


@lru_cache(maxsize=1)
def _own_sources() -> str:
    return _source_hash(Path(__file__).parents[1])


def _source_hash(root: Path) -> str:
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*")):
        if path.suffix in (".py", ".c", ".h", ".txt") and path.is_file():
            digest.update(path.relative_to(root).as_posix().encode() + b"\0")
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()
