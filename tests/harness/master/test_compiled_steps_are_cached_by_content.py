"""The cache of machine code is keyed by all that the code depends on, across modules."""

import os
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from harness.compiler.step import compile_step
from harness.system.block import KernelBlock, Port

HELPERS = """
from math import sin as wave
GAIN = 2.0
TABLE = (1.0, 2.0)
def helper(a, b=3.0):
    return GAIN * a + b
def other(a):
    return a
"""
STEP = """
import math
import numpy as np
from helpers import helper, other, wave, GAIN, TABLE
def step(p, x, u, y):
    y[0] = helper(u[0]) + other(0.0) * wave(GAIN * TABLE[1])
"""


@pytest.fixture(autouse=True)
def no_modules_are_left() -> Iterator[None]:
    yield
    for name in ("helpers", "steps", "notebook"):
        sys.modules.pop(name, None)


def module(name: str, text: str) -> ModuleType:
    made = ModuleType(name)
    sys.modules[name] = made
    exec(compile(text, f"{name}.py", "exec"), made.__dict__)
    return made


def address(helpers: str = HELPERS, step: str = STEP, sizes: int = 1) -> int:
    module("helpers", helpers)
    ports = tuple(Port(f"u{i}") for i in range(sizes))
    block = KernelBlock(ports, (Port("y"),), module("steps", step).step)
    return compile_step(block).address


def test_the_same_content_gives_the_same_code() -> None:
    assert address() == address()


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("GAIN * a + b", "GAIN * a - b"),
        ("GAIN = 2.0", "GAIN = 2.5"),
        ("TABLE = (1.0, 2.0)", "TABLE = (1.0, 3.0)"),
        ("b=3.0", "b=4.0"),
        ("import sin as wave", "import cos as wave"),
        ("return a\n", "return -a\n"),
        ("def other(a):\n    return a", "other = helper"),
    ],
)
def test_any_change_in_another_module_gives_other_code(before: str, after: str) -> None:
    assert before in HELPERS
    assert address() != address(HELPERS.replace(before, after))


def test_one_code_serves_all_sizes() -> None:
    assert address(sizes=1) == address(sizes=2)
    text = (
        "def step(p, x, u, y):\n    y[0] = 0.0\n    for i in range(len(u)):\n        y[0] += u[i]\n"
    )
    step = module("steps", text).step
    for n in (1, 2, 5):
        y = np.zeros(1)
        block = KernelBlock(tuple(Port(f"u{i}") for i in range(n)), (Port("y"),), step)
        compile_step(block)(np.zeros(0), np.zeros(0), np.arange(1.0, n + 1.0), y)
        assert y[0] == n * (n + 1) / 2


def test_a_global_number_changed_in_a_notebook_is_noticed() -> None:
    steps = module("notebook", "GAIN = 2.0\ndef step(p, x, u, y):\n    y[0] = GAIN * u[0]\n")
    block = KernelBlock((Port("u"),), (Port("y"),), steps.step)
    first = compile_step(block).address
    steps.GAIN = 3.0  # type: ignore[attr-defined]
    assert compile_step(block).address != first


SCRIPT = """
from harness.compiler.step import compile_step
from harness.system.lowering import delay_block
from harness.system.block import KernelBlock, Port
import {module} as steps
block = KernelBlock((Port("u"),), (Port("y"),), steps.step)
print([compile_step(one).code.cache_hits for one in (delay_block(1), block)])
"""


def hits(folder: Path, name: str) -> str:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "cache"),
                   "PYTHONPATH": os.pathsep.join([str(folder), str(Path.cwd())])}  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(module=name)], env=environment, text=True,
        capture_output=True, check=True,
    )  # fmt: skip
    return done.stdout.strip()


def test_another_process_finds_the_code_and_a_changed_helper_misses_it(tmp_path: Path) -> None:
    (tmp_path / "far.py").write_text("def helper(a):\n    return 2.0 * a\n")
    (tmp_path / "near.py").write_text(
        textwrap.dedent("""
        from far import helper
        def step(p, x, u, y):
            y[0] = helper(u[0])
        """)
    )
    assert hits(tmp_path, "near") == "[0, 0]"
    assert hits(tmp_path, "near") == "[1, 1]"
    (tmp_path / "far.py").write_text("def helper(a):\n    return 2.5 * a\n")
    assert hits(tmp_path, "near") == "[1, 0]"
