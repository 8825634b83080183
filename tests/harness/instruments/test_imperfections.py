"""Imperfections against their closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.random import SeedSequence

from harness.instruments.imperfections import (
    Bias,
    DelaySamples,
    Dropout,
    Gain,
    Lag,
    Noise,
    Quantisation,
    RateLimit,
    Saturation,
)
from harness.instruments.noise import WhiteNoise
from tests.harness.instruments.kernels import run

READINGS = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40).map(np.array)


@given(READINGS, st.floats(1e-3, 1e3))
def test_quantisation_gives_the_nearest_multiple(readings: np.ndarray, step: float) -> None:
    got = run(Quantisation(step).block(0.01), readings)
    assert np.all(np.abs(got - readings) <= 0.5 * step * (1 + 1e-9) + 1e-9)
    assert np.array_equal(got, step * np.round(readings / step))


def test_quantisation_is_mid_tread_and_without_bias() -> None:
    halves = np.array([-1.5, -0.5, -0.1, 0.0, 0.1, 0.5, 1.5])
    assert run(Quantisation(1.0).block(0.01), halves).tolist() == [-2, 0, 0, 0, 0, 0, 2]


@given(READINGS)
def test_memoryless_ones(readings: np.ndarray) -> None:
    assert np.array_equal(run(Bias(2.5).block(0.01), readings), readings + 2.5)
    assert np.array_equal(run(Gain(-3.0).block(0.01), readings), -3.0 * readings)
    assert np.array_equal(run(Saturation(-1, 5).block(0.01), readings), np.clip(readings, -1, 5))


@given(READINGS, st.integers(0, 50))
def test_delay_counts_readings(readings: np.ndarray, n: int) -> None:
    got = run(DelaySamples(n, initial=7.0).block(0.01), readings)
    assert np.array_equal(got, np.concatenate(([7.0] * n, readings))[: len(readings)])


@given(READINGS)
def test_rate_limit_moves_no_faster_and_passes_what_is_slower(readings: np.ndarray) -> None:
    block = RateLimit(100.0, falling_rate=50.0).block(0.01)
    got = run(block, readings)
    moves = np.diff(got)
    assert got[0] == readings[0]
    assert np.all(moves <= 1.0 + 1e-9)
    assert np.all(moves >= -0.5 - 1e-9)
    slow = np.cumsum(np.full(50, 0.25))
    assert np.array_equal(run(block, slow), slow)
    ramp = run(block, np.array([0.0, *([10.0] * 12)]))
    assert np.allclose(ramp, np.minimum(np.arange(13.0), 10.0), rtol=0, atol=1e-12)


def test_lag_settles_on_the_first_reading_and_follows_lines_exactly() -> None:
    T, h = 0.05, 0.01
    t = np.arange(200) * h
    assert np.allclose(run(Lag(T).block(h), np.full(50, 3.0)), 3.0, rtol=0, atol=1e-12)
    got = run(Lag(T).block(h), 2.0 * t)
    assert np.allclose(got, 2.0 * (t - T * (1 - np.exp(-t / T))), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("mode", "lost"), [("hold", [1, 1, 3, 3]), ("zero", [0, 0, 3, 0])])
def test_dropout_loses_below_its_probability(mode: str, lost: list[float]) -> None:
    block = Dropout(0.3, mode).block(0.01)
    got = run(block, np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.1, 0.29, 0.3, 0.0]))
    assert got.tolist() == lost


def test_dropout_loses_its_share() -> None:
    n, p = 20_000, 0.2
    imperfection = Dropout(p, "zero")
    assert imperfection.source is not None
    added = imperfection.source.sampler(SeedSequence(1)).sample(np.arange(n, dtype=np.int64))
    got = run(imperfection.block(0.01), np.ones(n), added)
    assert abs(np.mean(got == 0.0) - p) < 5 * np.sqrt(p * (1 - p) / n)


def test_noise_is_added_and_carries_the_unit_of_the_wire() -> None:
    noise = Noise(std=2.0)
    block = noise.block(0.01, "N")
    assert noise.source == WhiteNoise(2.0)
    assert [(port.name, port.unit) for port in block.inputs] == [("in", "N"), ("added", "N")]
    assert run(block, np.array([1.0, 2.0]), np.array([0.5, -4.0])).tolist() == [1.5, -2.0]
