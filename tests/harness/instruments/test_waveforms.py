"""Waveforms against their formulas."""

import numpy as np
import pytest
from numpy.random import SeedSequence

from harness.errors import SimulationError
from harness.instruments.composition import Function
from harness.instruments.noise import TAPS, Prbs
from harness.instruments.source import SignalSource
from harness.instruments.waveforms import Chirp, Sine

TIMES = np.arange(0, 5000, dtype=np.int64) * 1_000_000
SECONDS = TIMES / 1e9


def sampled(source: SignalSource) -> np.ndarray:
    return source.sampler(SeedSequence(0)).sample(TIMES)


def test_hertz_and_radians_say_the_same() -> None:
    hertz = sampled(Sine(2.0, frequency=3.0, phase=0.5, bias=1.0))
    radians = sampled(Sine(2.0, angular_frequency=2 * np.pi * 3.0, phase=0.5, bias=1.0))
    assert np.array_equal(hertz, radians)
    assert np.allclose(hertz, 1 + 2 * np.sin(6 * np.pi * SECONDS + 0.5), rtol=0, atol=1e-13)


@pytest.mark.parametrize("sweep", ["linear", "logarithmic"])
def test_a_chirp_has_the_frequency_of_its_sweep(sweep: str) -> None:
    f0, f1, T = 1.0, 20.0, 4.0
    angle = Chirp(1.0, f0, f1, T, sweep).angle
    t, h = np.linspace(0.01, 4.9, 500), 1e-6
    frequency = (angle(t + h) - angle(t - h)) / (2 * h) / (2 * np.pi)
    course = f0 + (f1 - f0) * t / T if sweep == "linear" else f0 * (f1 / f0) ** (t / T)
    assert np.allclose(frequency, np.where(t < T, course, f1), rtol=1e-5)
    assert angle(np.array([-1.0, 0.0])).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("order", sorted(TAPS))
def test_a_prbs_has_the_two_valued_autocorrelation_of_a_maximal_sequence(order: int) -> None:
    n = 2**order - 1
    times = np.arange(n, dtype=np.int64) * 1000
    x = Prbs(1.0, bit_time=1e-6, order=order).sampler(SeedSequence(4)).sample(times)
    assert set(x.tolist()) == {-1.0, 1.0}
    correlation = np.fft.ifft(np.abs(np.fft.fft(x)) ** 2).real
    assert np.array_equal(np.rint(correlation), [n, *([-1] * (n - 1))])
    assert np.max(np.abs(correlation - np.rint(correlation))) < 1e-6


def test_a_prbs_repeats_after_its_period_and_starts_by_its_seed() -> None:
    source = Prbs(2.0, bit_time=0.001, order=5, bias=1.0)
    x = sampled(source)
    assert np.array_equal(x[31:], x[:-31])
    assert set(x.tolist()) == {-1.0, 3.0}
    starts = {source.sampler(SeedSequence(i)).sample(TIMES[:31]).tobytes() for i in range(20)}
    assert len(starts) > 5


def test_a_function_is_called_with_seconds_and_its_fault_names_the_time() -> None:
    assert np.array_equal(sampled(Function(lambda t: 2 * t)), 2 * SECONDS)
    with pytest.raises(SimulationError, match=r"failed at t = 0 s: ZeroDivisionError"):
        sampled(Function(lambda t: 1 / t))
