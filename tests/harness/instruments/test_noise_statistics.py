"""Noises have the moments and the spectra that their docstrings state.

Each estimate is compared with its standard error; at 5 standard errors and fixed seeds a right
implementation fails never, a variance off by 3 % always.
"""

import numpy as np
import pytest
from numpy.random import SeedSequence
from scipy import signal, stats

from harness.instruments.noise import (
    BandLimitedNoise,
    ContaminatedNoise,
    HeavyTailedNoise,
    LowPassNoise,
    UniformNoise,
    WhiteNoise,
)
from harness.instruments.source import SignalSource

N = 200_000
PERIOD = 1_000_000  # ns
TIMES = np.arange(N, dtype=np.int64) * PERIOD


def sampled(source: SignalSource, seed: int = 11) -> np.ndarray:
    return source.sampler(SeedSequence(seed)).sample(TIMES)


@pytest.mark.parametrize(
    ("source", "mean", "variance", "kurtosis"),
    [
        (WhiteNoise(2.0, mean=0.5), 0.5, 4.0, 3.0),
        (UniformNoise(-1.0, 3.0), 1.0, 16 / 12, 1.8),
        (HeavyTailedNoise(2.0, dof=12.0, mean=1.0), 1.0, 4 * 12 / 10, 3 + 6 / 8),
        (ContaminatedNoise(1.0, 0.1, 3.0), 0.0, 1.8, 3 * 9.0 / 1.8**2),
    ],
)
def test_moments(source: SignalSource, mean: float, variance: float, kurtosis: float) -> None:
    x = sampled(source)
    assert abs(x.mean() - mean) < 5 * np.sqrt(variance / N)
    assert abs(x.var() - variance) < 5 * variance * np.sqrt((kurtosis - 1) / N)
    groups = x.reshape(100, -1)  # the spread over groups gives the standard error
    each = stats.kurtosis(groups, axis=1, fisher=False)
    assert abs(each.mean() - kurtosis) < 5 * each.std() / 10 + 0.02


@pytest.mark.parametrize("dof", [1.0, 3.0])
def test_student_noise_has_the_distribution_of_student(dof: float) -> None:
    x = sampled(HeavyTailedNoise(2.0, dof)) / 2.0
    assert stats.kstest(x, stats.t(dof).cdf).pvalue > 0.01


def test_white_noise_is_independent_from_sample_to_sample() -> None:
    x = sampled(WhiteNoise(1.0))
    lags = np.array([np.mean(x[k:] * x[:-k]) for k in range(1, 20)])
    assert np.all(np.abs(lags) < 5 / np.sqrt(N))


def test_band_limited_noise_has_its_power_density_and_variance() -> None:
    power, T = 0.3, 0.010
    x = sampled(BandLimitedNoise(power, T))
    rate = 1e9 / PERIOD
    assert abs(x.var() - power / T) < 5 * power / T * np.sqrt(2 / (N / 10))
    f, two_sided = signal.welch(x, rate, nperseg=2000, return_onesided=False, detrend=False)
    expected = power * np.sinc(f * T) ** 2
    low = (np.abs(f) > 0) & (np.abs(f) < 1 / (8 * T))
    averages = 2 * N / 2000 * 0.9  # windows, overlapping by half
    error = 5 * power / np.sqrt(averages * np.count_nonzero(low) / 2)
    assert abs(np.mean(two_sided[low] - expected[low])) < error


def test_band_limited_noise_is_held_over_its_sample_time() -> None:
    x = sampled(BandLimitedNoise(1.0, 0.010))[:1000].reshape(-1, 10)
    assert np.all(x == x[:, :1])
    assert len(np.unique(x[:, 0])) == len(x)


@pytest.mark.parametrize("stride", [1, 7])
def test_low_pass_noise_has_its_autocorrelation_at_any_rate(stride: int) -> None:
    std, bandwidth = 2.0, 20.0
    times = TIMES * stride
    x = LowPassNoise(std, bandwidth).sampler(SeedSequence(2)).sample(times)
    a = np.exp(-2 * np.pi * bandwidth * stride * PERIOD / 1e9)
    effective = N * (1 - a) / (1 + a)  # independent samples that the correlated ones are worth
    for lag in (0, 1, 5):
        estimate = np.mean(x[lag:] * x[: N - lag])
        assert abs(estimate - std**2 * a**lag) < 5 * std**2 * np.sqrt(2 / effective)
