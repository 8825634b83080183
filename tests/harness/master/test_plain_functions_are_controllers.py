"""What a plain Python function may be: its arguments, its parameters, and what it returns."""

from typing import Any

import numpy as np
import pytest

from harness.bench import Bench
from harness.errors import UsageError


def bench(function: Any, **options: Any) -> Bench:
    made = Bench(stop_time=0.2, step=0.1)
    made.signal("two", "constant", value=2.0)
    made.controller("c", function, **options)
    made.connect("two", "c.y")
    return made


def gain(time: float, y: float, k: float = 3.0, *, offset: float = 0.0) -> float:
    return k * y + offset


@pytest.mark.parametrize(
    ("options", "expected"), [({}, 6.0), ({"k": 2.0}, 4.0), ({"offset": 1.0, "k": -1.0}, -1.0)]
)
def test_arguments_with_a_default_are_parameters(options: Any, expected: float) -> None:
    assert set(bench(gain, **options).run()["c.u"]) == {expected}


@pytest.mark.parametrize("shape", [(1,), (1, 1), ()])
def test_an_array_of_one_element_is_a_number(shape: tuple[int, ...]) -> None:
    assert set(bench(lambda time, y: np.full(shape, y)).run()["c.u"]) == {2.0}


@pytest.mark.parametrize("shape", [(2,), (2, 1), (1, 2)])
def test_an_array_is_one_number_an_output(shape: tuple[int, ...]) -> None:
    result = bench(lambda time, y: np.reshape([y, -y], shape), outputs=("a", "b")).run()
    assert set(result["c.a"]) == {2.0} and set(result["c.b"]) == {-2.0}


@pytest.mark.parametrize(
    ("source", "options", "words"),
    [
        (max, {}, r"component c: <built-in function max> does not say what arguments it takes"),
        (gain, {"kk": 1.0}, r"component c: 'kk' is no argument with a default .* did you mean 'k'"),
        (lambda time, *y: 0.0, {}, r"takes \(time, input, input, …\) by position, not \(time, \*y"),
    ],
)
def test_what_is_refused(source: Any, options: Any, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        bench(source, **options)
