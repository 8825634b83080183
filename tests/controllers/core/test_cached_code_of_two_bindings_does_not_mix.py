"""Code cached by different processes, of one template bound to two models, stays apart."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from controllers.core.bind import bind
from controllers.core.block import Array, Block, Signal
from harness.compiler.step import compile_step


def model(p: Array, x: Array, rate: Array) -> None:
    """Placeholder."""


def helper(p: Array, x: Array, rate: Array) -> None:
    """Long enough not to be inlined: only then it has a symbol of its own."""
    for i in range(int(x[0])):
        for j in range(int(x[0])):
            model(p, x, rate)
            if i * j > 7:
                model(p, x, rate)
            for k in range(i):
                rate[0] = rate[0] + np.sin(0.0 * k) + np.cos(0.0 * j) - np.exp(0.0 * k)
            model(p, x, rate)


def template(p: Array, x: Array, u: Array, y: Array) -> None:
    helper(p, x, y)
    helper(p, x, u)
    y[0] = y[0] + u[0]


def plus(p: Array, x: Array, rate: Array) -> None:
    rate[0] = rate[0] + np.floor(x[0])


def minus(p: Array, x: Array, rate: Array) -> None:
    rate[0] = rate[0] - np.floor(x[0])


STEPS = {f.__name__: bind(template, helper=bind(helper, model=f)) for f in (plus, minus)}


def compiled(name: str) -> float:
    block = Block((Signal("u"),), (Signal("y"),), STEPS[name], state=np.array([3.0]))
    code = compile_step(block)
    arrays = np.zeros(1), np.array([3.0]), np.zeros(1), np.zeros(1)
    code(*arrays)
    return float(arrays[3][0])


def test_each_is_compiled_in_its_own_process_and_both_are_loaded_into_a_third(
    tmp_path: Path,
) -> None:
    script = f"import sys; from {__name__} import compiled; print(*map(compiled, sys.argv[1:]))"
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(Path.cwd())}

    def apart(*names: str) -> list[float]:
        command = [sys.executable, "-c", script, *names]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        return [float(word) for word in done.stdout.split()]

    (up,), (down,) = apart("plus"), apart("minus")
    assert up == -down > 0.0
    assert apart("plus", "minus") == [up, down]
    assert apart("minus", "plus") == [down, up]
