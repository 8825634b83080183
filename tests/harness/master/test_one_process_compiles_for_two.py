"""Where two processes need a step that is not compiled yet, one compiles it, the other waits."""

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
from harness.compiler.step import compile_step
from controllers.pid.pid import PID
block = PID(kp=1.0, u_min=-1.0, u_max=1.0).block(0.01)
print("ready", flush=True)
input()
print(compile_step(block).code.cache_hits)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="files are locked by fcntl")
def test_one_of_two_finds_it(tmp_path: Path) -> None:
    environment = {"NUMBA_CACHE_DIR": str(tmp_path), "PATH": "", "HOME": str(tmp_path)}
    two = [
        subprocess.Popen(
            [sys.executable, "-c", PROGRAM], env=environment, cwd=Path(__file__).parents[3],
            text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )
        for _ in range(2)
    ]  # fmt: skip
    for one in two:
        assert one.stdout is not None and one.stdout.readline() == "ready\n"
    for one in two:
        assert one.stdin is not None
        one.stdin.write("\n")
        one.stdin.flush()
    assert sorted(int(one.communicate()[0]) for one in two) == [0, 1]
