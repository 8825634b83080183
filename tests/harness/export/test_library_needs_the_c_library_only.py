"""The shared library shows the FMI functions and asks for nothing but the C library."""

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from harness.compiler.native import LIBRARY, native_step
from harness.export.controller import controller_fmu
from tests.harness.export.blocks import counter, example, pid

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or shutil.which("nm") is None, reason="reads ELF with nm"
)
C_LIBRARY = LIBRARY | {
    "calloc", "free", "malloc", "strlen", "strcmp", "memcmp", "snprintf", "vsnprintf", "llround",
}  # fmt: skip
START_UP = {"__cxa_finalize", "__gmon_start__", "_ITM_deregisterTMCloneTable",
            "_ITM_registerTMCloneTable", "__stack_chk_fail"}  # fmt: skip


def symbols(path: Path, which: str, folder: Path) -> set[str]:
    with zipfile.ZipFile(path) as archive:
        (library,) = (n for n in archive.namelist() if n.endswith(".so"))
        archive.extract(library, folder)
    listed = subprocess.run(
        ["nm", "--dynamic", which, str(folder / library)],
        capture_output=True,
        text=True,
        check=True,
    )
    return {line.split()[-1].partition("@")[0] for line in listed.stdout.splitlines()}


@pytest.mark.parametrize("name", ["counter", "pid", "two_mass_controller"])
def test_symbols(name: str, version: int, tmp_path: Path) -> None:
    block = {"counter": counter, "pid": pid}.get(name, lambda: example(name)[0])()
    path = controller_fmu(block, "block", 0.01, version)
    assert symbols(path, "--undefined-only", tmp_path) <= C_LIBRARY | START_UP
    shown = symbols(path, "--defined-only", tmp_path)
    assert f"fmi{version}DoStep" in shown
    assert all(re.fullmatch(rf"fmi{version}\w+", symbol) for symbol in shown)


def test_the_module_names_no_machine() -> None:
    text = native_step(pid())
    assert not re.search(r"target|llvm\.x86|_ZN|numba|NRT|0x7f", text)
    assert "define hidden" in text


def test_the_module_is_the_same_in_another_process() -> None:
    script = (
        "import sys; from tests.harness.export.blocks import pid, example\n"
        "from harness.compiler.native import native_step\n"
        "native_step(example('gain')[0]); sys.stdout.write(native_step(pid()))"
    )
    root = Path(__file__).parents[3]
    other = subprocess.run(
        [sys.executable, "-c", script],
        cwd=root, capture_output=True, text=True, check=True,
        env={"PYTHONPATH": str(root), "PYTHONHASHSEED": "3", "NUMBA_CPU_NAME": "generic",
             "NUMBA_CPU_FEATURES": ""},
    )  # fmt: skip
    assert other.stdout == native_step(pid())
