"""Innovation of the servo's filter, on the FMU in the loop, over seeds 1 to 5.

Matched: normalised innovations ν/√S are white and their squares have the mean 1. With N samples
of a white sequence the autocorrelations r_j have N·Σr_j² ~ χ² with as many degrees of freedom as
lags (Ljung and Box), and the mean square has the standard error √(2/N).
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from harness.experiment.experiment import Experiment

FIGURE_8 = Path(__file__).parents[2] / "experiments/raheem2013/figure_8.toml"
SEEDS = range(1, 6)
LAGS = 20
SETTINGS = {"record_step": 1e-4, "stop_time": 2.0, "record": ["*"]}


@cache
def normalised(variant: str, seed: int, filter_name: str) -> np.ndarray:
    """ν/√S after the change at 0.95 s, of the changed or of the nominal servo's filter."""
    result = Experiment.load(FIGURE_8, SETTINGS).run(variant, seed=seed)
    after = result.time >= 0.95
    name = f"{filter_name}.innovation"
    values = result[f"{name}_measured"][after] / result[f"{name}_std_measured"][after]
    return np.asarray(values)


def portmanteau(values: np.ndarray) -> float:
    """N·Σr_j² over the lags."""
    centred = values - values.mean()
    r = [centred[j:] @ centred[:-j] / (centred @ centred) for j in range(1, LAGS + 1)]
    return float(len(values) * np.sum(np.square(r)))


def over_seeds(variant: str, filter_name: str) -> tuple[float, float, int]:
    """Mean square, portmanteau statistic summed over the seeds, number of samples."""
    runs = [normalised(variant, seed, filter_name) for seed in SEEDS]
    every = np.concatenate(runs)
    return float(np.mean(every**2)), sum(map(portmanteau, runs)), len(every)


WHITE_BELOW = float(chi2.ppf(0.999, LAGS * len(SEEDS)))  # 149
MATCHED = [("matched", "nominal_filter"), ("position", "nominal_filter")]


@pytest.mark.parametrize(("variant", "filter_name"), MATCHED)
def test_matched_filter(variant: str, filter_name: str) -> None:
    mean_square, statistic, samples = over_seeds(variant, filter_name)
    assert abs(mean_square - 1.0) < 3.3 * np.sqrt(2.0 / samples)
    assert statistic < WHITE_BELOW


@pytest.mark.parametrize("variant", ["worst_matched", "worst_position"])
def test_filter_that_believes_half_of_the_stiffness(variant: str) -> None:
    mean_square, statistic, _ = over_seeds(variant, "filter")
    assert mean_square > 1.5
    assert statistic > 20 * WHITE_BELOW


def test_filter_that_believes_too_much_noise() -> None:
    mean_square, statistic, _ = over_seeds("inflated", "nominal_filter")
    assert mean_square < 0.7
    assert statistic > 20 * WHITE_BELOW
