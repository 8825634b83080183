"""FilterPy: its extended Kalman filter on the pendulum."""

import math
from typing import Any

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from benchmarks.peers.task import OfRow, carry_out_rows


class Pendulum(ExtendedKalmanFilter):
    """Its prediction is the map of the model."""

    def __init__(self, model: dict[str, Any]) -> None:
        """Before the first measurement."""
        super().__init__(dim_x=2, dim_z=1)
        self.T, self.a, self.b = model["T"], model["a"], model["b"]
        self.x, self.P = np.array(model["x_0"]), np.array(model["P_0"])
        self.Q, self.R = np.diag([0.0, model["q"] * self.T**2]), np.array([[model["R"]]])

    def predict_x(self, u: float = 0.0) -> None:
        """One sample on."""
        angle, speed = self.x
        rate = -self.a * math.sin(angle) - self.b * speed
        self.F = np.array(
            [[1.0, self.T], [-self.T * self.a * math.cos(angle), 1.0 - self.T * self.b]]
        )
        self.x = np.array([angle + self.T * speed, speed + self.T * rate])


def sensor(x: np.ndarray) -> np.ndarray:
    return np.array([math.sin(x[0])])


def slope(x: np.ndarray) -> np.ndarray:
    return np.array([[math.cos(x[0]), 0.0]])


def prepare(model: dict[str, Any]) -> OfRow:
    estimator, started = Pendulum(model), False

    def compute(row: list[float]) -> list[float]:
        nonlocal started
        if started:
            estimator.predict()
        started = True
        estimator.update(np.array(row), slope, sensor)
        return estimator.x.tolist()

    return compute


carry_out_rows(prepare)
