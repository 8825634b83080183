"""At the instant of an edge the new value holds, to the nanosecond."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.random import SeedSequence

from harness.clock import nearest_nanosecond, seconds_of
from harness.instruments.source import SignalSource
from harness.instruments.waveforms import MultiStep, Pulse, Ramp, Square, Step


def at(source: SignalSource, *instants: int) -> list[float]:
    return source.sampler(SeedSequence(0)).sample(np.array(instants, dtype=np.int64)).tolist()


@given(st.integers(-(10**15), 10**15))
def test_a_step_switches_at_its_nanosecond(edge: int) -> None:
    assert at(Step(1.0, time=edge / 1e9), edge - 1, edge, edge + 1) == [0.0, 1.0, 1.0]


@pytest.mark.parametrize("written", [0.3, 0.1 + 0.2, 3 * 0.1, 0.3 - 1e-12])
def test_rounding_of_the_written_time_does_not_move_the_edge(written: float) -> None:
    assert at(Step(1.0, time=written), 299_999_999, 300_000_000) == [0.0, 1.0]


def test_every_sample_instant_of_a_grid_is_an_exact_edge() -> None:
    for k in range(1, 2000):
        assert nearest_nanosecond(k * 0.01) == k * 10_000_000
        assert float(seconds_of(np.array([k * 10_000_000]))[0]) == float(f"{k / 100:.2f}")


@given(st.lists(st.integers(0, 10**12), min_size=1, max_size=8, unique=True))
def test_a_multi_step_switches_at_each_of_its_times(edges: list[int]) -> None:
    edges = sorted(edges)
    levels = [float(i + 1) for i in range(len(edges))]
    source = MultiStep(tuple(edge / 1e9 for edge in edges), tuple(levels), initial=-1.0)
    assert at(source, *edges) == levels
    before = [edge - 1 for edge in edges]
    expected = [max((v for e, v in zip(edges, levels, strict=True) if e <= t), default=-1.0)
                for t in before]  # fmt: skip
    assert at(source, *before) == expected


def test_square_and_pulse_switch_at_their_nanoseconds_after_many_periods() -> None:
    ms = 1_000_000
    square = Square(1.0, period=0.03, start_time=0.01)
    pulse = Pulse(2.0, width=0.01, period=0.03, start_time=0.01, bias=1.0)
    for n in (0, 1, 10**6):
        t = (10 + 30 * n) * ms
        before = 0.0 if n == 0 else -1.0
        assert at(square, t - 1, t, t + 15 * ms - 1, t + 15 * ms) == [before, 1.0, 1.0, -1.0]
        assert at(pulse, t - 1, t, t + 10 * ms - 1, t + 10 * ms) == [1.0, 3.0, 3.0, 1.0]
    assert at(Pulse(2.0, 0.01), -1, 0, 10 * ms - 1, 10 * ms, 10**12) == [0.0, 2.0, 2.0, 0.0, 0.0]


def test_a_ramp_begins_and_ends_at_its_times() -> None:
    ramp = Ramp(10.0, start_time=0.1, end_time=0.3, initial=5.0)
    values = at(ramp, 0, 100_000_000, 200_000_000, 300_000_000, 10**12)
    assert values == [5.0, 5.0, 6.0, 7.0, 7.0]
