"""The archive of an FMU: its token, its binaries, its bytes.

The same files give the same bytes: entries are sorted, dated 1980-01-01 and carry the same
permissions; the token is a hash of everything that was generated.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import uuid
import zipfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fmus.packaging.c_source import MAIN_SOURCE
from fmus.packaging.compiler import Target, compile_library

UNKNOWN_TOKEN = "{00000000-0000-0000-0000-000000000000}"
"""What stands for the token while it is computed."""


def content_token(files: dict[str, bytes]) -> str:
    """A token in GUID form, the hash of the files."""
    return f"{{{uuid.UUID(bytes=bytes.fromhex(content_hash(files))[:16])}}}"


def content_hash(files: dict[str, bytes]) -> str:
    """SHA-256 over names, lengths and contents, in the order of names."""
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\0{len(files[name])}\0".encode())
        digest.update(files[name])
    return digest.hexdigest()


def compiled_binaries(
    name: str,
    fmi_version: int,
    sources: Mapping[str, bytes],
    targets: Sequence[Target],
    object_for: Callable[[str], bytes] | None = None,
) -> dict[str, bytes]:
    """The shared libraries by path in the archive, one a target.

    `object_for` gives an object file for a platform tuple, to be linked with the sources.
    """
    objects = [object_for(t.platform.tuple) if object_for else None for t in targets]

    def compiled(target: Target, step: bytes | None) -> bytes:
        with tempfile.TemporaryDirectory(prefix="fmu-harness-") as folder:
            for source, data in sources.items():
                Path(folder, source).write_bytes(data)
            if step is not None:
                Path(folder, "step.o").write_bytes(step)
            library = Path(folder, f"{name}{target.platform.suffix}")
            linked = () if step is None else ("step.o",)
            compile_library(
                target.compiler, Path(folder), MAIN_SOURCE, library, fmi_version, linked
            )
            return library.read_bytes()

    with ThreadPoolExecutor(os.cpu_count()) as pool:  # each thread waits for a compiler's process
        libraries = list(pool.map(compiled, targets, objects))
    places = [f"{t.platform.folder(fmi_version)}/{name}{t.platform.suffix}" for t in targets]
    return {f"binaries/{place}": data for place, data in zip(places, libraries, strict=True)}


def write_archive(files: dict[str, bytes], path: Path) -> None:
    """A zip file whose bytes depend on `files` only; the model description comes first."""
    with zipfile.ZipFile(path, "w") as archive:
        for name in sorted(files, key=lambda n: (n != "modelDescription.xml", n)):
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, files[name])
