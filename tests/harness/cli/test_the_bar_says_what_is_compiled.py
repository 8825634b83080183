"""Where machine code is not there yet, whoever asks is told what is being compiled."""

import subprocess
import sys
from pathlib import Path

PROGRAM = """
import numpy as np
from harness.compiler.machine_code import announcing
from harness.compiler.step import compile_step
from controllers.signals.gain import Gain
told = []
with announcing(told.append):
    compile_step(Gain(gain=2.0).block(0.01))
print(told)
"""


def test_it_is_told_once_for_each_machine(tmp_path: Path) -> None:
    environment = {"NUMBA_CACHE_DIR": str(tmp_path), "PATH": "", "HOME": str(tmp_path)}
    said = [
        subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, text=True, capture_output=True,
            check=True, cwd=Path(__file__).parents[3],
        ).stdout
        for _ in range(2)
    ]  # fmt: skip
    assert said == ["['controllers.signals.gain.gain_step']\n", "[]\n"]
