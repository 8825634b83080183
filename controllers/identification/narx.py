"""Time series as rows for a static model: y_k from past outputs and past inputs (NARX).

With L_y lags of each of m outputs and L_u lags of each of q inputs the regressor for y_k is

    x = (y¹_{k−1}, …, y¹_{k−L_y}, y²_{k−1}, …, u¹_{k−1}, …, u¹_{k−L_u}, …)

where u_{k−1} is the input held over [t_{k−1}, t_k], so its coefficient is the sensitivity of the
output over one sample. A history array *is* the regressor of the instant that comes next. All
values are scaled: a range (low, high) in physical units becomes [−1, 1].

This module refuses to know the model behind `predict`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array
from controllers.core.errors import require, require_finite

SIMULATION_LIMIT = 10.0  # half-ranges at which a free run that runs away is held


def push(history: Array, first: int, lags: int, value: float) -> None:
    """The newest `value` of the signal whose `lags` entries begin at `first`; the oldest goes."""
    for j in range(lags - 1, 0, -1):
        history[first + j] = history[first + j - 1]
    history[first] = value


@dataclass(frozen=True)
class Scale:
    """A range (low, high) of a signal that is mapped to [−1, 1]."""

    low: float
    high: float

    def __post_init__(self) -> None:
        """Raise `ControllerError` unless low < high, both finite."""
        require_finite("range: low", self.low)
        require_finite("range: high", self.high)
        require(self.low < self.high, "range", "low below high", (self.low, self.high))

    @property
    def centre(self) -> float:
        """Middle of the range, mapped to 0."""
        return 0.5 * (self.low + self.high)

    @property
    def half(self) -> float:
        """Half the range: one scaled unit."""
        return 0.5 * (self.high - self.low)

    def scaled(self, values: Array) -> Array:
        """Physical values in scaled units."""
        return (np.asarray(values, dtype=np.float64) - self.centre) / self.half

    def physical(self, values: Array) -> Array:
        """Scaled values in physical units."""
        return np.asarray(values, dtype=np.float64) * self.half + self.centre


@dataclass(frozen=True)
class Lags:
    """m `outputs` with `output_lags` each and q `inputs` with `input_lags` each."""

    outputs: int = 1
    inputs: int = 1
    output_lags: int = 2
    input_lags: int = 2

    def __post_init__(self) -> None:
        """Raise `ControllerError` for counts below 1 (inputs and their lags: below 0)."""
        for name, least in (("outputs", 1), ("inputs", 0), ("output_lags", 1), ("input_lags", 0)):
            value = getattr(self, name)
            require(value >= least, f"Lags.{name}", f"at least {least}", value)

    @property
    def size(self) -> int:
        """Length n of the regressor."""
        return self.outputs * self.output_lags + self.inputs * self.input_lags

    @property
    def first(self) -> int:
        """First instant whose regressor is known."""
        return max(self.output_lags, self.input_lags)

    def names(self, outputs: Sequence[str], inputs: Sequence[str]) -> tuple[str, ...]:
        """Names of the regressor's components: `force_1` is the force one sample back."""
        pairs = [(name, self.output_lags) for name in outputs]
        pairs += [(name, self.input_lags) for name in inputs]
        return tuple(f"{name}_{j}" for name, lags in pairs for j in range(1, lags + 1))

    def rows(self, y: Array, u: Array) -> tuple[Array, Array]:
        """X (N − first, n) and Y (N − first, m) of the series y (N, m), u (N, q): u[k] is held
        from instant k on."""
        self._check(y, u)
        columns = [
            series[self.first - j : len(y) - j, i]
            for series, count, lags in (
                (y, self.outputs, self.output_lags),
                (u, self.inputs, self.input_lags),
            )
            for i in range(count)
            for j in range(1, lags + 1)
        ]
        return np.column_stack(columns), np.array(y[self.first :])

    def free_run(self, predict: Callable[[Array], Array], y: Array, u: Array) -> Array:
        """The series (N, m) that `predict` (X (1, n) to Y (1, m)) makes of u (N, q) and of its
        own outputs, the first of which are those of y; held at `SIMULATION_LIMIT`."""
        self._check(y, u)
        made = np.array(y, dtype=np.float64)
        for k in range(self.first, len(made)):
            window = slice(k - self.first, k + 1)
            made[k] = np.clip(
                predict(self.rows(made[window], u[window])[0])[0],
                -SIMULATION_LIMIT,
                SIMULATION_LIMIT,
            )
        return made

    def _check(self, y: Array, u: Array) -> None:
        expected = f"shapes (N, {self.outputs}) and (N, {self.inputs}), N > {self.first}"
        received = (np.shape(y), np.shape(u))
        fits = received == ((len(y), self.outputs), (len(y), self.inputs)) and len(y) > self.first
        require(fits, "Lags: series y, u", expected, received)


def fit(measured: Array, modelled: Array) -> float:
    """100·(1 − ‖y − ŷ‖/‖y − ȳ‖) in %, the usual fit of system identification: 100 is exact, 0 as
    good as the mean."""
    spread = np.linalg.norm(measured - np.mean(measured, axis=0))
    return float(100.0 * (1.0 - np.linalg.norm(measured - modelled) / spread))
