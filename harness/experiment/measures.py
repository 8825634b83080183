"""The metrics that an experiment asks for, computed of a result."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from harness import registry
from harness.errors import UsageError
from harness.experiment.schema import ExperimentSpec, MeasureSpec, MetricSpec
from harness.results.metrics import FIGURES, after_events, rms
from harness.results.result import Result
from harness.results.step_response import segment_metrics, segments, tracking_metrics

MEASURED = ("steady_state_mean", "steady_state_rms", "steady_state_max", "iae")
"""What is also reported of the response as the controller sees it."""

Metrics = dict[str, float | None]


def needed_signals(spec: ExperimentSpec) -> Iterator[str]:
    """The signals that `measure` and `metrics` are computed of."""
    if spec.measure is not None:
        m = spec.measure
        yield from (name for name in (m.reference, m.response, m.control, m.measured) if name)
    for metric in spec.metrics.values():
        others = (metric.minus, metric.relative_to)
        yield metric.signal
        yield from (name for name in (*others, *metric.norm_with) if isinstance(name, str))


def tracking(result: Result, m: MeasureSpec) -> Metrics:
    """The figures of the last step of the reference, and of each step where there are several
    ("2/rise_time"). A reference that moves otherwise has no times of its own."""
    found = _response(result, m, m.response)
    if m.measured is not None:
        seen = _response(result, m, m.measured)
        found |= {f"measured_{name}": seen[name] for name in MEASURED}
    return found


def _response(result: Result, m: MeasureSpec, response: str) -> Metrics:
    reference = result.numbers(m.reference)
    arrays = (result.time, reference, result.numbers(response), result.numbers(m.control))
    window: Any = {"window": m.window, "window_time": m.window_time}
    try:
        segments(result.time, reference)
    except UsageError:
        return {k: float(v) for k, v in asdict(tracking_metrics(*arrays, **window)).items()}
    steps = segment_metrics(*arrays, band=m.band, dwell=m.dwell, **window)
    if not steps:
        return {}
    found = steps[-1].as_dict()
    if len(steps) > 1:
        for i, step in enumerate(steps, 1):
            found |= {f"{i}/{name}": value for name, value in step.as_dict().items()}
    return found


def custom(result: Result, spec: MetricSpec) -> float | None:
    """One figure of `[metrics]`; None where no row lies between its times. At an event the row
    after it counts, and for the largest value both."""
    rows = after_events(result.time) | (spec.kind == "max_abs")
    if spec.start is not None:
        rows &= result.time >= spec.start
    if spec.end is not None:
        rows &= result.time <= spec.end
    if not rows.any():
        return None
    values = result.numbers(spec.signal)[rows]
    if spec.minus is not None:
        values = values - result.numbers(spec.minus)[rows]
    if spec.norm_with:
        others = (result.numbers(name)[rows] for name in spec.norm_with)
        values = np.sqrt(values**2 + sum(other**2 for other in others))
    scale = 1.0
    if isinstance(spec.relative_to, str):
        scale = rms(result.numbers(spec.relative_to)[rows])
    elif spec.relative_to is not None:
        scale = spec.relative_to
    if not scale:
        return None
    of = FIGURES.get(spec.kind) or registry.named(spec.kind, "metric")
    figure = float(of(values)) / scale
    return figure if spec.above is None else float(not figure <= spec.above)
