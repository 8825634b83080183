"""Programs for other machines, and what runs them here: qemu-user for aarch64, wine for Windows.

On Debian: `apt install qemu-user libc6-arm64-cross wine64`, and `pip install ziglang`.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
from fmpy import read_model_description
from numpy.typing import NDArray

from controllers.core.block import Block
from fmus.packaging.compiler import PLATFORMS, cross_compiler
from harness.export.controller import controller_fmu

WINE = next(
    (path for path in ("/usr/lib/wine/wine64", shutil.which("wine") or "") if Path(path).is_file()),
    None,
)
ARM_LIBRARIES = Path("/usr/aarch64-linux-gnu")
HAS_ZIG = importlib.util.find_spec("ziglang") is not None
EMULATORS = {
    "x86_64-linux": [] if sys.platform == "linux" else None,
    "aarch64-linux": ["qemu-aarch64", "-L", str(ARM_LIBRARIES)]
    if shutil.which("qemu-aarch64") and ARM_LIBRARIES.is_dir()
    else None,
    "x86_64-windows": [WINE] if WINE else None,
}


def build_driver(platform: str, folder: Path) -> Path:
    """The driver as a program for `platform`."""
    compiler = cross_compiler(platform)
    assert compiler is not None
    program = folder / f"driver-{platform}.exe"
    source = Path(__file__).with_name("driver.c")
    links = [] if platform.endswith("windows") else ["-ldl"]
    command = [*compiler.command, "-std=c99", "-O1", str(source), "-o", str(program), *links]
    subprocess.run(command, check=True, capture_output=True)
    return program


def run_there(
    platform: str, block: Block, sample_time: float, inputs: NDArray[np.float64], folder: Path
) -> NDArray[np.float64]:
    """The outputs of the block's FMU on that platform for rows of inputs."""
    emulator = EMULATORS[platform]
    assert emulator is not None
    path = controller_fmu(block, "block", sample_time, 2, targets=[platform])
    library = PLATFORMS[platform].folder(2) + "/block" + PLATFORMS[platform].suffix
    with zipfile.ZipFile(path) as archive:
        archive.extract(f"binaries/{library}", folder)
    token = read_model_description(str(path)).guid
    arguments = [
        *emulator, str(build_driver(platform, folder)), f"binaries/{library}", token,
        repr(sample_time), "1", str(len(block.inputs)), str(len(block.outputs)),
    ]  # fmt: skip
    done = subprocess.run(
        arguments,
        cwd=folder,
        input=inputs.tobytes(),
        capture_output=True,
        timeout=300,
        check=False,
        env={**os.environ, "WINEDEBUG": "-all", "WINEPREFIX": str(folder / "wine")},
    )
    assert done.returncode == 0, done.stderr.decode(errors="replace")
    return np.frombuffer(done.stdout).reshape(len(inputs), len(block.outputs))
