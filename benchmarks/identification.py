"""ms a row of `identify`: in plain Python, compiled, and a filter in numpy of the same size.

    python -m benchmarks.identification [--rows 60] [--sets 5]

A Takagi–Sugeno model of two inputs and one output with `sets`² rules is learnt from rows of noise.
The numpy side does the filter's work alone (P·Hᵀ, the gain, P − K·H·P, symmetry), with the
Jacobian given. All sides run in turn, several rounds; processor time of the median round.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from benchmarks.measuring import interleaved
from controllers.core.block import Array
from controllers.fuzzy.takagi_sugeno import TakagiSugeno, grid, partition
from controllers.identification.offline import Uncertainty, identify
from harness.compiler.step import compile_step

ROUNDS = 7
COMPILED = "ours, identify compiled"
R = 1e-4


def numpy_filter(n: int, rows: int) -> None:
    """The filter step of one output and n parameters, `rows` times."""
    rng = np.random.default_rng(1)
    theta, P, H = np.zeros(n), np.eye(n), rng.normal(size=(rows, n))
    for h in H:
        PH = P @ h
        K = PH / (h @ PH + R)
        theta = theta + K * (1.0 - h @ theta)
        P = P - np.outer(K, PH)
        P = 0.5 * (P + P.T)


def model_of(sets: int) -> TakagiSugeno:
    """`sets` Gaussian sets on each of two inputs."""
    return grid([partition("gaussian", sets)] * 2, [[0.0, 0.0, 0.0]])


def seconds(run: Callable[[], object]) -> float:
    """Processor time of one run."""
    began = time.process_time()
    run()
    return time.process_time() - began


def sides_of(sets: int, rows: int) -> dict[str, Callable[[], float]]:
    """By name what measures ms a row; the interpreted side learns a tenth of the rows."""
    model, rng = model_of(sets), np.random.default_rng(0)
    X: Array = rng.uniform(-1.0, 1.0, (rows, 2))
    Y = np.sin(2.0 * X[:, :1]) * X[:, 1:]
    adaptation, few = Uncertainty().adaptation(model, (R,)), max(1, rows // 10)
    n = len(adaptation.free)
    sides: dict[str, tuple[int, Callable[[], object]]] = {
        COMPILED: (rows, lambda: identify(model, X, Y, adaptation, compile=compile_step)),
        f"a filter in numpy, {n} parameters": (rows, lambda: numpy_filter(n, rows)),
        "ours, identify in plain Python": (
            few, lambda: identify(model, X[:few], Y[:few], adaptation),
        ),
    }  # fmt: skip
    return {name: lambda c=c, run=run: 1e3 * seconds(run) / c for name, (c, run) in sides.items()}


def measure(sets: int, rows: int) -> dict[str, float]:
    """ms a row of each side, the median of the rounds."""
    found = interleaved(sides_of(sets, rows), ROUNDS)
    return {name: series.median for name, series in found.items()}


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=60)
    parser.add_argument("--sets", type=int, default=7)
    given = parser.parse_args()
    for name, milliseconds in measure(given.sets, given.rows).items():
        print(f"{name:36} {milliseconds:8.3f} ms a row")


if __name__ == "__main__":
    main()
