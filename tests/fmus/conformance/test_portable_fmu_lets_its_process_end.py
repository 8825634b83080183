"""A process that used a portable FMU ends without touching memory it has given back.

Every `operator delete` of C++ fills its block with ones and keeps it, so that any later use of an
object in it goes astray at once and not only where the heap happens to lie badly.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from fmus.packaging.compiler import find_compiler
from fmus.plant import Plant
from tests.fmus.conformance.processes import run_python

POISON = """
#include <stddef.h>
void _ZdlPvm(void *block, size_t size) {
    for (size_t i = 0; i < size / sizeof(int); i++) {
        ((int *)block)[i] = 1;
    }
}
"""


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="replaces a function by LD_PRELOAD"
)
def test_nothing_deleted_is_used(plant: Plant, tmp_path: Path) -> None:
    compiler = find_compiler()
    assert compiler is not None
    (tmp_path / "poison.c").write_text(POISON)
    library = tmp_path / "poison.so"
    command = [*compiler.command, "-shared", "-fPIC", "-o", library, tmp_path / "poison.c"]
    subprocess.run(command, check=True)
    fmu = plant.fmu(2, portable=True)
    arguments = ("-m", "tests.fmus.conformance.stored_run", fmu, "store", tmp_path)
    run_python(*arguments, changed={"LD_PRELOAD": str(library)})
