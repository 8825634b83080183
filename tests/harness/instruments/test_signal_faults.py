"""A fault in a signal or imperfection is one sentence with the kind, the key and the way out."""

from typing import Any

import pytest

from harness.errors import ExperimentError
from harness.instruments.imperfections import make_imperfection
from harness.instruments.signals import make_signal

SINE = {"kind": "sine", "amplitude": 1.0, "frequency": 1.0, "unit": "N"}


@pytest.mark.parametrize(
    ("kind", "given", "said"),
    [
        ("stepp", {}, "unknown signal kind 'stepp': did you mean 'step'"),
        (["step"], {}, "unknown signal kind"),
        ("sine", {"amplitude": 1, "freq": 2}, "'sine' has no key 'freq': did you mean 'frequency'"),
        ("step", {}, "signal 'step' lacks 'final': its keys are final, time, initial, unit"),
        ("sine", {"amplitude": 1}, "'sine': give either 'frequency' or 'angular_frequency'"),
        ("sine", {"amplitude": True, "frequency": 1}, "'amplitude' must be a finite number"),
        ("step", {"final": "2"}, "'step': 'final' must be a finite number, got '2'"),
        ("step", {"final": float("nan")}, "'final' must be a finite number, got nan"),
        ("step", {"final": 1, "time": 1e10}, "'time' must be a finite number at least -9.2e"),
        ("multi_step", {"times": [1, 1], "values": [1, 2]}, "must increase by at least 1 ns"),
        ("multi_step", {"times": [1], "values": [1, 2]}, "of one length, at least 1, got 1 and 2"),
        ("multi_step", {"times": 1, "values": [1]}, "'times' must hold numbers, got 1"),
        ("ramp", {"slope": 1, "start_time": 2, "end_time": 1},
         "'end_time' must not be below 'start_time' 2, got 1"),
        ("chirp", {"amplitude": 1, "start_frequency": 0, "end_frequency": 1, "duration": 1,
                   "sweep": "logarithmic"}, "'start_frequency' must be a finite number above 0"),
        ("square", {"amplitude": 1, "period": 1, "duty": 1}, "'duty' must be .* above 0 and below"),
        ("pulse", {"amplitude": 1, "width": 2, "period": 1},
         "'period' must not be below 'width' 2, got 1"),
        ("prbs", {"amplitude": 1, "bit_time": 1, "order": 99}, "whole number from 3 to 16, got 99"),
        ("white_noise", {"std": -1}, "'std' must be a finite number at least 0, got -1"),
        ("uniform", {"low": 1, "high": 0}, "'high' must not be below 'low' 1, got 0"),
        ("csv", {"file": "nowhere.csv", "column": "x"}, "no existing file: 'nowhere.csv'"),
        ("function", {"function": "sin"}, "must be a Python callable, got 'sin'"),
        ("sum", {"signals": []}, "'sum': 'signals' must hold at least one signal"),
        ("sum", {"signals": [{"std": 1}]}, "'sum': a signal inside it lacks 'kind', got .* std"),
        ("sum", {"signals": [SINE, SINE | {"unit": "m"}]}, "must have one unit, got N, m"),
        ("scaled", {"signal": 3}, "'scaled': a signal .* was expected, got 3"),
        ("constant", {"value": 1, "unit": 5}, "'unit' must be a unit such as 'N' or 'm/s', got 5"),
    ],
)  # fmt: skip
def test_signal_fault(kind: Any, given: dict[str, Any], said: str) -> None:
    with pytest.raises(ExperimentError, match=said) as fault:
        make_signal(kind, given)
    assert "\n" not in str(fault.value)


@pytest.mark.parametrize(
    ("kind", "given", "said"),
    [
        ("drop", {}, "unknown imperfection kind 'drop': did you mean 'dropout'"),
        ("noise", {}, "'noise': give either 'std' or 'signal', got None and None"),
        ("noise", {"std": 1, "signal": SINE}, "give either 'std' or 'signal'"),
        ("noise", {"signal": {"kind": "sin"}}, "unknown signal kind 'sin': did you mean 'sine'"),
        ("disturbance", {"signal": 1}, "'disturbance': a signal .* was expected, got 1"),
        ("quantisation", {"step": 0}, "'step' must be a finite number above 0, got 0"),
        ("saturation", {"lower": 1, "upper": 0}, "'upper' must not be below 'lower' 1, got 0"),
        ("delay_samples", {"samples": 1.5}, "'samples' must be a whole number from 0 to"),
        ("dropout", {"probability": 1.5}, "'probability' must be .* at least 0 and at most 1"),
        ("dropout", {"probability": 0.5, "mode": "keep"}, "must be one of 'hold', 'zero'"),
        ("lag", {"time_constant": 0}, "'time_constant' must be a finite number at least 1e-09"),
    ],
)
def test_imperfection_fault(kind: str, given: dict[str, Any], said: str) -> None:
    with pytest.raises(ExperimentError, match=said) as fault:
        make_imperfection(kind, given)
    assert "\n" not in str(fault.value)


def test_a_unit_inside_a_sum_or_window_is_that_of_the_whole() -> None:
    assert make_signal("sum", {"signals": [SINE, {"kind": "constant", "value": 1}]}).unit == "N"
    assert make_signal("windowed", {"signal": SINE}).unit == "N"
    assert make_signal("scaled", {"signal": SINE}).unit is None
