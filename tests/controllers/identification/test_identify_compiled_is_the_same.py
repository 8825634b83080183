"""`identify` compiled gives what it gives in plain Python, to the bit."""

import numpy as np

from controllers.fuzzy.takagi_sugeno import grid, partition
from controllers.identification.offline import Uncertainty, identify
from harness.compiler.step import compile_step


def test_to_the_bit() -> None:
    rng = np.random.default_rng(3)
    X = rng.uniform(-1.0, 1.0, (60, 2))
    Y = np.column_stack([np.sin(2.0 * X[:, 0]) * X[:, 1], X[:, 0] - X[:, 1] ** 2])
    start = grid(
        [partition("gaussian", 3), partition("triangular", 2)], [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    )
    uncertainty = Uncertainty(consequent_drift=1e-4)
    for name in ("ekf", "robust_ekf"):
        adaptation = uncertainty.adaptation(start, (1e-4, 1e-3), filter=name)
        plain = identify(start, X, Y, adaptation, passes=2)
        compiled = identify(start, X, Y, adaptation, passes=2, compile=compile_step)
        assert compiled.model.theta().tolist() == plain.model.theta().tolist()
        assert not np.array_equal(plain.model.theta(), start.theta())
        for field in ("P", "predicted", "gamma", "normalised_innovation_squared"):
            assert np.array_equal(getattr(compiled, field), getattr(plain, field))
