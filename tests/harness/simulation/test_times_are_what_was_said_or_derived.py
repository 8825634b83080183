"""Defaults: the user's word, else the FMU's, else derived and said; instants are exact."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.fmi.description.model_description import ModelDescription
from harness.fmi.fmu import Fmu
from harness.participants.grid import Grid
from harness.participants.settings import Request, Settings, derived, settle
from tests.harness.simulation.fmus import model_fmu, needs_compiler


@pytest.fixture(scope="module")
def plain() -> ModelDescription:
    with Fmu(model_fmu("3")) as fmu:
        return fmu.description


def settled(d: ModelDescription, fixed: float | None = None, **request: object) -> Settings:
    assert d.co_simulation is not None
    stepping = replace(d.co_simulation, fixed_internal_step_size=fixed)
    return settle(Request(**request), replace(d, co_simulation=stepping))  # type: ignore[arg-type]


@needs_compiler
def test_nothing_said_is_derived_and_noted(plain: ModelDescription) -> None:
    s = settled(plain)
    assert (s.start_time, s.stop_time, s.step_size, s.output_interval) == (0.0, 1.0, 0.002, None)
    assert len(s.notes) == 2 and "stop time" in s.notes[0] and "0.002 s was derived" in s.notes[1]


@needs_compiler
def test_the_step_is_the_internal_one_before_the_default_experiments(
    plain: ModelDescription,
) -> None:
    d = replace(plain, start_time=1.0, stop_time=3.0, step_size=0.1, tolerance=1e-4)
    s = settled(d)
    assert (s.start_time, s.stop_time, s.step_size, s.relative_tolerance) == (1.0, 3.0, 0.1, 1e-4)
    assert settled(d, fixed=0.01).step_size == 0.01
    assert settled(d, fixed=0.01, step_size=0.02).step_size == 0.02
    assert settled(d, stop_time=2.0, start_time=0.5, relative_tolerance=1e-8).notes == ()


@needs_compiler
def test_an_output_interval_alone_is_the_step_where_the_fmu_can_take_it(
    plain: ModelDescription,
) -> None:
    assert settled(plain, output_interval=0.3).step_size == 0.3
    assert settled(plain, fixed=0.1, output_interval=0.3).step_size == 0.3
    assert settled(plain, fixed=0.1, output_interval=0.25).step_size == 0.1


@needs_compiler
def test_a_tiny_internal_step_is_bundled_and_said(plain: ModelDescription) -> None:
    s = settled(plain, fixed=1e-6, stop_time=10.0)
    assert s.step_size == 1e-3 and "would need 1e+07 steps" in s.notes[0]


@needs_compiler
def test_model_exchange_records_at_the_default_step(plain: ModelDescription) -> None:
    s = settled(replace(plain, step_size=0.05), interface_type="me", stop_time=1.0)
    assert (s.output_interval, s.step_size, s.notes) == (0.05, None, ())
    assert settled(plain, interface_type="ModelExchange", solver="euler").step_size == 0.002


@pytest.mark.parametrize(
    ("length", "step"), [(1.0, 0.002), (10.0, 0.02), (2.0, 0.005), (3600.0, 10.0), (1e-6, 2e-9)]
)
def test_derived_steps_are_round(length: float, step: float) -> None:
    assert derived(length) == step


@given(
    start=st.decimals(-100, 100, places=4).map(float), step=st.decimals("0.0001", 10, places=4),
    k=st.integers(0, 10**6),
)  # fmt: skip
def test_instants_are_the_nearest_doubles(start: float, step: object, k: int) -> None:
    grid = Grid.of(start, float(str(step)))
    exact = Fraction(repr(start)) + k * Fraction(str(step))
    assert grid.at(k) == float(exact) and grid.holds(grid.at(k))
    assert grid.after(grid.at(k)) == grid.at(k + 1)
