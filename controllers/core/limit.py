"""Limiting a number, as limits of outputs, states and parameters have it."""


def limit(value: float, low: float, high: float) -> float:
    """`value` limited to [low, high]; NaN stays NaN."""
    if value > high:
        return high
    if value < low:
        return low
    return value
