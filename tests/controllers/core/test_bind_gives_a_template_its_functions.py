"""A bound step is a plain function of its own: it runs, compiles and is told apart from others."""

import numpy as np
import pytest

from controllers.core.bind import bind
from controllers.core.block import Array, Block, Signal
from controllers.core.errors import ControllerError
from harness.compiler.step import compile_step

GAIN = 3.0


def model(p: Array, x: Array, rate: Array) -> None:
    """Placeholder."""


def helper(p: Array, x: Array, rate: Array) -> None:
    model(p, x, rate)
    rate[0] = rate[0] + 1.0


def template(p: Array, x: Array, u: Array, y: Array) -> None:
    model(p, x, y)
    y[0] = y[0] + u[0]


def nested(p: Array, x: Array, u: Array, y: Array) -> None:
    helper(p, x, y)


def double(p: Array, x: Array, rate: Array) -> None:
    rate[0] = 2.0 * x[0]


def triple(p: Array, x: Array, rate: Array) -> None:
    rate[0] = GAIN * x[0]


def block(step: object) -> Block:
    return Block((Signal("u"),), (Signal("y"),), step, state=np.array([5.0]))  # type: ignore[arg-type]


def interpreted(step: object) -> float:
    y = np.zeros(1)
    step(np.zeros(0), np.array([5.0]), np.array([0.5]), y)  # type: ignore[operator]
    return float(y[0])


def compiled(step: object) -> float:
    code = compile_step(block(step))
    arrays = np.zeros(1), np.array([5.0]), np.array([0.5]), np.zeros(1)
    code(*arrays)
    return float(arrays[3][0])


CASES = [
    (bind(template, model=double), 10.5),
    (bind(template, model=triple), 15.5),
    (bind(nested, helper=bind(helper, model=double)), 11.0),
    (bind(nested, helper=bind(helper, model=triple)), 16.0),
]


@pytest.mark.parametrize(("step", "expected"), CASES)
def test_interpreted_and_compiled(step: object, expected: float) -> None:
    assert interpreted(step) == expected
    assert compiled(step) == expected


def test_two_bindings_leave_each_other_and_the_template_alone() -> None:
    assert interpreted(template) == 0.5
    first, second = bind(template, model=double), bind(template, model=triple)
    assert (interpreted(first), interpreted(second), interpreted(first)) == (10.5, 15.5, 10.5)
    assert first.__qualname__ == "template(model=double)"


def test_faults_name_the_legal_choices() -> None:
    with pytest.raises(ControllerError, match=r"names: model, received 'modell'"):
        bind(template, modell=double)
    with pytest.raises(ControllerError, match=r"the arguments \(p, x, rate\), received"):
        bind(template, model=template)
    with pytest.raises(ControllerError, match="plain function"):
        bind(template, model=np.sin)
    scale = 2.0

    def closed(p: Array, x: Array, rate: Array) -> None:
        rate[0] = scale

    with pytest.raises(ControllerError, match="enclosing function"):
        bind(template, model=closed)


def three(p: Array, x: Array, u: Array, y: Array) -> None:
    model(p, x, y)
    y[0] = 10.0 * y[0]
    helper(p, x, u)
    y[0] = y[0] + u[0]
    third(p, x, u)
    y[0] = y[0] + 100.0 * u[0]


def third(p: Array, x: Array, rate: Array) -> None:
    """Placeholder."""


def test_which_function_stands_where_decides_and_not_only_which_are_named() -> None:
    first = bind(three, model=double, helper=triple, third=double)
    second = bind(three, model=double, helper=triple, third=triple)
    assert compiled(first) == 100.0 + 15.0 + 1000.0
    assert compiled(second) == 100.0 + 15.0 + 1500.0
