"""What compiled code cannot do is refused in one sentence that names the step function."""

import math
import random
from typing import Any

import numpy as np
import pytest
from numba import njit

from harness.compiler.step import CompileError, compile_step
from harness.system.block import Array, KernelBlock, Port

SETTINGS = {"gain": 2.0}


def block(step: Any) -> KernelBlock:
    return KernelBlock((Port("u"),), (Port("y"),), step, np.array([2.0]), np.array([3.0]))


def raises(p: Array, x: Array, u: Array, y: Array) -> None:
    if u[0] < 0:
        raise ValueError("negative")


def asserts(p: Array, x: Array, u: Array, y: Array) -> None:
    assert u[0] >= 0


def calls_what_raises(p: Array, x: Array, u: Array, y: Array) -> None:
    raises(p, x, u, y)


def recurses(p: Array, x: Array, u: Array, y: Array) -> None:
    if u[0] > 0:
        u[0] -= 1
        recurses(p, x, u, y)


def uses_a_dictionary(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = SETTINGS["gain"] * u[0]


def uses_another_module(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = random.random()


def cannot_be_typed(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = "text" + u[0]  # type: ignore[operator]


def closure() -> Any:
    gain = 2.0

    def step(p: Array, x: Array, u: Array, y: Array) -> None:
        y[0] = gain * u[0]

    return step


@pytest.mark.parametrize(
    ("step", "words"),
    [
        (raises, r"raises \(line \d+\) raises an exception.*write NaN"),
        (asserts, r"asserts \(line \d+\) raises an exception"),
        (calls_what_raises, r"\.raises \(line \d+\) raises an exception"),
        (recurses, "recurses calls itself.*write a loop"),
        (uses_a_dictionary, "uses SETTINGS, a dict; it may use"),
        (uses_another_module, "uses random, a module random; it may use"),
        (cannot_be_typed, "cannot_be_typed cannot be compiled: .*plain Python block"),
        (closure(), r"closure.*step uses variables of an enclosing function; pass them"),
        (math.sin, "is no plain Python function"),
    ],
)
def test_refused_in_one_sentence(step: Any, words: str) -> None:
    with pytest.raises(CompileError, match=words) as caught:
        compile_step(block(step))
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400


@njit
def decorated(a: float) -> float:
    return 2.0 * a


def uses_a_compiled_helper(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = decorated(u[0]) + math.sqrt(p[0]) + np.sign(x[0])
    x[0] = min(x[0], u[0])


def test_helpers_compiled_by_numba_are_welcome_and_bits_agree() -> None:
    compiled = compile_step(block(uses_a_compiled_helper))
    arrays = [np.array([v]) for v in (2.0, 3.0, 0.7, 0.0)]
    expected = [a.copy() for a in arrays]
    compiled(*arrays)
    uses_a_compiled_helper(*expected)
    assert [a[0] for a in arrays] == [a[0] for a in expected]


def test_division_by_zero_gives_infinity_not_an_exception() -> None:
    arrays = [np.array([v]) for v in (2.0, 3.0, 0.0, 0.0)]
    compile_step(block(inverts))(*arrays)
    assert arrays[3][0] == math.inf


def inverts(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = 1.0 / u[0]
