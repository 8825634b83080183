"""scikit-fuzzy: its membership functions; rules and mean by numpy, for it has Mamdani's alone."""

from typing import Any

import numpy as np
import skfuzzy

from benchmarks.peers.task import OfRow, carry_out_rows


def prepare(model: dict[str, Any]) -> OfRow:
    width, centres = model["width"], model["centres"]
    weights = np.array(model["weights"])[np.array(model["table"])]

    def degrees(value: float) -> np.ndarray:
        at = np.array([value])
        corners = ([c - width, c, c + width] for c in centres)
        return np.array([skfuzzy.trimf(at, abc)[0] for abc in corners])

    def compute(row: list[float]) -> list[float]:
        firing = np.minimum.outer(degrees(row[0]), degrees(row[1]))
        return [float((firing * weights).sum() / firing.sum())]

    return compute


carry_out_rows(prepare)
