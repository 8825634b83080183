"""All metrics of a step response, or of each step of a multi-step reference, gathered."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError
from harness.results import metrics

Array = NDArray[np.float64]

SHORTEST_SEGMENT = 3  # samples; a reference that moves more often is no sequence of steps


def _figure(unit: str) -> Any:
    """A field in a unit that may depend on those of the response, y, and of the control, u."""
    return field(metadata={"unit": unit})


@dataclass(frozen=True)
class TrackingMetrics:
    """What can be said for any reference; definitions in `harness.results.metrics`.

    `steady_state_*` in % of the reference over the final window; integrals in the unit of the
    response times s; control figures in the unit of the control.
    """

    steady_state_mean: float = _figure("%")
    steady_state_rms: float = _figure("%")
    steady_state_max: float = _figure("%")
    iae: float = _figure("{y}·s")
    ise: float = _figure("{y}²·s")
    itae: float = _figure("{y}·s²")
    control_effort: float = _figure("{u}²·s")
    control_rms: float = _figure("{u}")
    actuator_travel: float = _figure("{u}")
    lost_loop: bool = _figure("0 or 1")


@dataclass(frozen=True)
class StepMetrics:
    """One step: `start` (s) its instant, `initial` and `final` the reference before and after,
    times in s since the step (None where never), `overshoot` in %, `band` the share of the step
    that counts as settled, and the tracking figures from the step to the end."""

    start: float
    initial: float
    final: float
    band: float
    tracking: TrackingMetrics
    delay_time: float | None = _figure("s")
    rise_time: float | None = _figure("s")
    overshoot: float = _figure("%")
    settling_time: float | None = _figure("s")

    def as_dict(self) -> dict[str, float | None]:
        """The figures by name, flat, for tables and files; `lost_loop` as 0 or 1."""
        own = {one.name: getattr(self, one.name) for one in fields(self) if one.metadata}
        return own | {name: float(value) for name, value in asdict(self.tracking).items()}


def metric_units(response_unit: str, control_unit: str) -> dict[str, str]:
    """The unit of each name in `StepMetrics.as_dict`."""
    return {
        one.name: one.metadata["unit"].format(y=response_unit, u=control_unit)
        for one in (*fields(StepMetrics), *fields(TrackingMetrics))
        if one.metadata
    }


def tracking_metrics(
    time: Array,
    reference: Array,
    response: Array,
    control: Array,
    *,
    window: float = 0.1,
    window_time: float | None = None,
) -> TrackingMetrics:
    """The figures that any reference allows; `window` is the final share of the time that counts
    as steady state, `window_time` states it in seconds instead, and all of the time where that is
    shorter."""
    check_arrays(time, reference=reference, response=response, control=control)
    if window_time is not None:
        window = min(window_time / float(time[-1] - time[0]), 1.0)
    window_rows = metrics.final_window(time, window)
    end = metrics.after_events(time)
    end[: window_rows.start] = False
    return TrackingMetrics(
        steady_state_mean=metrics.steady_state_mean(reference[end], response[end]),
        steady_state_rms=metrics.steady_state_rms(reference[end], response[end]),
        steady_state_max=metrics.steady_state_max(reference[window_rows], response[window_rows]),
        iae=metrics.iae(time, reference, response),
        ise=metrics.ise(time, reference, response),
        itae=metrics.itae(time, reference, response),
        control_effort=metrics.control_effort(time, control),
        control_rms=metrics.control_rms(time, control),
        actuator_travel=metrics.actuator_travel(control),
        lost_loop=metrics.lost_loop(time, reference, response, window=window),
    )


def segment_metrics(
    time: Array,
    reference: Array,
    response: Array,
    control: Array,
    *,
    band: float = 0.02,
    window: float = 0.1,
    window_time: float | None = None,
    dwell: float = 0.0,
) -> tuple[StepMetrics, ...]:
    """The metrics of each step of the reference, each from its step to the sample before the next.

    What comes before the first change of the reference belongs to no step, except where the
    response starts elsewhere than the reference: then that is the first step. So a reference that
    is constant throughout counts as a step at the first sample. Raises `UsageError` for a reference
    that is no sequence of steps.
    """
    check_arrays(time, reference=reference, response=response, control=control)
    made = []
    initial, final = 0.0, float(response[0])
    for part in segments(time, reference):
        initial, final = final, float(reference[part.start])
        if initial == final:
            continue
        t, y = time[part], response[part]
        made.append(
            StepMetrics(
                start=float(t[0]),
                initial=initial,
                final=final,
                band=band,
                delay_time=metrics.delay_time(t, y, initial, final),
                rise_time=metrics.rise_time(t, y, initial, final),
                overshoot=metrics.overshoot(y, initial, final),
                settling_time=metrics.settling_time(t, y, initial, final, band, dwell),
                tracking=tracking_metrics(
                    t, reference[part], y, control[part], window=window, window_time=window_time
                ),
            )
        )
    return tuple(made)


def segments(time: Array, reference: Array) -> tuple[slice, ...]:
    """The stretches of samples over which the reference is constant.

    Raises `UsageError` where one is shorter than 3 samples: such a reference moves, and only
    `tracking_metrics` makes sense of it.
    """
    changes = np.flatnonzero(np.diff(reference) != 0.0) + 1
    edges = [0, *changes.tolist(), len(reference)]
    parts = tuple(
        slice(a, b) for a, b in pairwise(edges) if b == len(time) or time[a] < time[b]
    )  # what the reference only passes at an event belongs to no step
    for part in parts:
        if part.stop - part.start < SHORTEST_SEGMENT:
            raise UsageError(
                f"the reference is no sequence of steps: it holds its value at t = "
                f"{time[part.start]:g} s for {part.stop - part.start} samples, at least "
                f"{SHORTEST_SEGMENT} were expected; use tracking_metrics"
            )
    return parts


def check_arrays(time: Array, **others: Array) -> None:
    """All arrays have the length of `time`, at least 2, and the time does not decrease."""
    for name, values in others.items():
        if values.shape != time.shape:
            raise UsageError(
                f"{name} has shape {values.shape}, but time has shape {time.shape}; metrics need "
                "one value a sample"
            )
    if len(time) < 2 or not (np.all(np.diff(time) >= 0.0) and time[-1] > time[0]):
        raise UsageError("metrics need at least two samples at times that do not decrease")
