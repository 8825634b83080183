"""Where a step cannot be native code, the error names file, line, construct and the way out."""

import inspect
import math

import numpy as np
import pytest

from controllers.core.block import Array, Block, Signal, StepFunction
from harness.compiler.native import native_key, native_step
from harness.compiler.step import CompileError


def raises(p: Array, x: Array, u: Array, y: Array) -> None:
    if u[0] > 1.0:
        raise ValueError("too much")  # here


def asserts(p: Array, x: Array, u: Array, y: Array) -> None:
    assert u[0] < 1.0  # here


def lists(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = max([u[0], 1.0])  # here


def allocates(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = np.zeros(3)[0]  # here


def prints(p: Array, x: Array, u: Array, y: Array) -> None:
    print(u[0])  # here


def matrix(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = x @ x  # here


def added(x: Array) -> Array:
    return x[0:3] + x[3:6]  # here, as `adds` calls it


def adds(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = 1.0
    y[0] = added(x)[0]


def scales(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = u[0]
    x[0:3] = x[0:3] * 2.0  # here


def draws(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = np.random.normal()  # here


def misnames(p: Array, x: Array, u: Array, y: Array) -> None:
    y[0] = u["error"]  # here


CASES = [
    (raises, raises, "raises an exception; write NaN"),
    (asserts, asserts, "asserts; check when the controller is made"),
    (lists, lists, "makes a list; give the block's state room"),
    (allocates, allocates, "calls np.zeros(), which allocates memory"),
    (prints, prints, "calls print(); offer the value as an output"),
    (matrix, matrix, "multiplies matrices with @; write a loop"),
    (adds, added, "allocates memory (as the sum of two slices does"),
    (scales, scales, "allocates memory (as the sum of two slices does"),
    (draws, draws, "which only Python's runtime has"),
    (misnames, misnames, '(y[0] = u["error"]  # here) is nothing the compiler knows'),
]


def block(step: StepFunction) -> Block:
    return Block((Signal("u"),), (Signal("y"),), step, state=np.zeros(6))


@pytest.mark.parametrize(("step", "place", "words"), CASES, ids=lambda case: str(case)[:20])
def test_line_construct_and_way_out(step: StepFunction, place: StepFunction, words: str) -> None:
    lines, first = inspect.getsourcelines(place)
    line = first + next(i for i, text in enumerate(lines) if "# here" in text)
    with pytest.raises(CompileError) as fault:
        native_step(block(step))
    assert f"{__file__}:{line} " in str(fault.value)
    assert words in str(fault.value)


def test_what_the_source_shows_is_refused_before_the_cache_is_asked() -> None:
    with pytest.raises(CompileError, match="makes a list"):
        native_key(block(lists))


def views(p: Array, x: Array, u: Array, y: Array) -> None:
    rows = x[0:6].reshape(2, 3)
    rows[1, 2] += u[0]
    y[0] = rows[1, 2] + math.exp(x.sum()) + np.max(x)


def test_views_sums_and_mathematics_are_taken() -> None:
    assert "block_reshape" in native_step(block(views))
