"""What is measured of a control loop. Each figure is defined where it stands.

Arrays have shape (n,): `time` t_k in seconds, not always evenly increasing; `reference` r_k and
`response` y_k in one unit; `control` u_k in its own. At an event a time repeats: the row before it,
then that after it. The error is e = r − y. A step goes from y_0
(the reference before it) to y_1 (the reference after it), its size is Δ = y_1 − y_0, and times are
counted from the step's own instant.

Choices that matter with noise:
- a response crosses a level when it reaches it for the first time; the instant is found on the
  straight line between the two samples around it;
- settling looks at every sample, so that one outlier outside the band un-settles the response;
- e, e² and t·|e| are integrated by the trapezoidal rule (error O(h²) between smooth samples);
  u is held between samples, so ∫u² is the exact sum of u_k²·(t_{k+1} − t_k);
- at an event integrals have both sides and the time between them, none; extremes look at both,
  means and what holds at the end at the value after it (`after_events`);
- what cannot be said (a level never reached, never settled) is None, and never a large number.

Where a reference has several steps, `segments` cuts it; see `harness.results.step_response`.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError

Array = NDArray[np.float64]


def after_events(time: Array) -> NDArray[np.bool_]:
    """Which rows are the last of their time (shape (n,)): every row where there are no events."""
    return np.append(np.diff(time) > 0.0, [True] * min(len(time), 1))


def first_crossing(time: Array, response: Array, level: float, *, rising: bool) -> float | None:
    """First instant (s) at which the response reaches `level` from below (`rising`) or above.

    Linear between samples; time[0] where the response is there from the start; None where it
    never is.
    """
    reached = response >= level if rising else response <= level
    k = int(np.argmax(reached))
    if not reached[k]:
        return None
    if k == 0:
        return float(time[0])
    share = (level - response[k - 1]) / (response[k] - response[k - 1])
    return float(time[k - 1] + share * (time[k] - time[k - 1]))


def delay_time(time: Array, response: Array, initial: float, final: float) -> float | None:
    """Time (s) from time[0] to the first crossing of 50 % of the step from initial to final."""
    level = initial + 0.5 * (final - initial)
    crossing = first_crossing(time, response, level, rising=final > initial)
    return None if crossing is None else crossing - float(time[0])


def rise_time(time: Array, response: Array, initial: float, final: float) -> float | None:
    """Time (s) between the first crossings of 10 % and of 90 % of the step."""
    size, rising = final - initial, final > initial
    low = first_crossing(time, response, initial + 0.1 * size, rising=rising)
    high = first_crossing(time, response, initial + 0.9 * size, rising=rising)
    return None if low is None or high is None else high - low


def overshoot(response: Array, initial: float, final: float) -> float:
    """max(0, max_k (y_k − y_1)/Δ)·100 %: the highest sample beyond the final value."""
    beyond = (response - final) / (final - initial)
    return 100.0 * max(0.0, float(np.max(beyond)))


def settling_time(
    time: Array,
    response: Array,
    initial: float,
    final: float,
    band: float = 0.02,
    dwell: float = 0.0,
) -> float | None:
    """Time (s) from time[0] after which |y − y_1| ≤ band·|Δ| to the end; None where the last
    sample is outside the band, or what is left until the end is shorter than `dwell` (s). The
    entry is found on the line between two samples."""
    width = band * abs(final - initial)
    distance = response - final
    outside = np.flatnonzero(~(np.abs(distance) <= width))
    if len(outside) == 0:
        return 0.0
    k = int(outside[-1])
    if k == len(time) - 1:
        return None
    edge = math.copysign(width, float(distance[k]))
    share = (edge - distance[k]) / (distance[k + 1] - distance[k])
    entry = float(time[k] + share * (time[k + 1] - time[k]))
    return entry - float(time[0]) if float(time[-1]) - entry >= dwell else None


def final_window(time: Array, share: float) -> slice:
    """The samples of the last `share` (0 to 1) of the time span, at least one."""
    if not 0.0 < share <= 1.0:
        raise UsageError(f"the final window must be a share of the time in (0, 1], got {share!r}")
    begin = time[-1] - share * (time[-1] - time[0])
    return slice(min(int(np.searchsorted(time, begin, "left")), len(time) - 1), None)


def relative_error(reference: Array, response: Array) -> Array:
    """100·(r − y)/|r| in % of the reference, sample by sample; infinite or NaN where r = 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(100.0 * (reference - response) / np.abs(reference))


def steady_state_mean(reference: Array, response: Array) -> float:
    """Mean of 100·(r − y)/|r| over a window, in %: the offset, positive where y is too low."""
    with np.errstate(invalid="ignore"):  # where r = 0 there is no share of it: NaN
        return float(np.mean(relative_error(reference, response)))


def steady_state_rms(reference: Array, response: Array) -> float:
    """Root of the mean square of 100·(r − y)/|r| over a window, in %: offset and ripple."""
    return float(np.sqrt(np.mean(relative_error(reference, response) ** 2)))


def steady_state_max(reference: Array, response: Array) -> float:
    """Largest |100·(r − y)/r| over a window, in %."""
    return float(np.max(np.abs(relative_error(reference, response))))


def iae(time: Array, reference: Array, response: Array) -> float:
    """∫|e| dt, in unit·s."""
    return float(np.trapezoid(np.abs(reference - response), time))


def ise(time: Array, reference: Array, response: Array) -> float:
    """∫e² dt, in unit²·s."""
    return float(np.trapezoid((reference - response) ** 2, time))


def itae(time: Array, reference: Array, response: Array) -> float:
    """∫(t − t_0)·|e| dt, in unit·s²: late errors weigh more."""
    return float(np.trapezoid((time - time[0]) * np.abs(reference - response), time))


def control_effort(time: Array, control: Array) -> float:
    """∫u² dt = Σ u_k²·(t_{k+1} − t_k) for a held control, in unit²·s."""
    return float(np.sum(control[:-1] ** 2 * np.diff(time)))


def control_rms(time: Array, control: Array) -> float:
    """√(∫u² dt / T) over the time span T, in the unit of the control."""
    return math.sqrt(control_effort(time, control) / float(time[-1] - time[0]))


def actuator_travel(control: Array) -> float:
    """Σ|u_k − u_{k−1}|, in the unit of the control: the way the actuator is sent, its wear."""
    return float(np.sum(np.abs(np.diff(control))))


def lost_loop(
    time: Array,
    reference: Array,
    response: Array,
    *,
    limit: float = 0.2,
    window: float = 0.1,
    divergence: float = 10.0,
) -> bool:
    """Whether the controller lost the loop. It has, when one of these holds:

    - the response is not finite somewhere;
    - √(mean e²) over the final `window` (share of the time) exceeds `limit`·√(mean r²) over it,
      the error "at the end" (root mean square, so that one noisy last sample decides nothing);
    - |e| exceeds `divergence`·max|r| anywhere.
    """
    if not np.all(np.isfinite(response)):
        return True
    error = reference - response
    end = after_events(time)
    end[: final_window(time, window).start] = False
    at_end = np.sqrt(np.mean(error[end] ** 2)) > limit * np.sqrt(np.mean(reference[end] ** 2))
    diverged = np.max(np.abs(error)) > divergence * np.max(np.abs(reference))
    return bool(at_end or diverged)


def rms(values: Array) -> float:
    """√(mean v²), in the unit of the values."""
    return float(np.sqrt(np.mean(values * values)))


def largest_fall(values: Array) -> float:
    """max_k (max_{j ≤ k} v_j − v_k): how far the values fall from what they had reached; 0 where
    they only rise."""
    return float(np.max(np.maximum.accumulate(values) - values))


FIGURES: dict[str, Callable[[Array], float]] = {
    "rms": rms,
    "mean": lambda values: float(np.mean(values)),
    "mean_abs": lambda values: float(np.mean(np.abs(values))),
    "max_abs": lambda values: float(np.max(np.abs(values))),
    "std": lambda values: float(np.std(values)),
    "final": lambda values: float(values[-1]),
    "largest_fall": largest_fall,
    "final_abs": lambda values: float(abs(values[-1])),
}
"""The kinds of `[metrics]` in an experiment file: one number of the values of a window, (n,)."""
