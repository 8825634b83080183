"""The block of a signal shows, when the step to t_k is over, the sample of t_k: exactly."""

import numpy as np
import pytest

from harness.errors import ExperimentError
from harness.instruments.signals import make_signal
from harness.instruments.source import named_seed
from harness.ssp.sequence import sequence_block
from harness.system.graph import SignalComponent, System

MS = 1_000_000


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [
        ("constant", {"value": 2.5}),
        ("step", {"time": 0.05, "initial": -1.0, "final": 3.0}),
        ("sine", {"amplitude": 2.0, "frequency": 3.0}),
        ("white_noise", {"std": 1.0}),
    ],
)
def test_samples(kind: str, parameters: dict[str, float]) -> None:
    signal = SignalComponent("s", make_signal(kind, parameters), 10 * MS)
    system = System((signal,), (), 20 * MS, 220 * MS, 10 * MS, seed=4)
    block = sequence_block(signal, system, "V")
    instants = np.arange(20, 221, 10) * MS
    expected = signal.source.sampler(named_seed(4, "s")).sample(instants)
    x, y, seen = block.state.copy(), np.zeros(1), [block.outputs[0].start]
    for _ in range(len(instants) - 1):
        block.step(block.parameters, x, np.zeros(0), y)
        seen.append(y[0])
    assert np.array_equal(seen, expected)
    for _ in range(3):
        block.step(block.parameters, x, np.zeros(0), y)
    assert y[0] == expected[-1], "the last sample is held"
    assert block.outputs[0].unit == "V"


def test_what_changes_too_often_is_refused() -> None:
    signal = SignalComponent("s", make_signal("white_noise", {"std": 1.0}), MS)
    system = System((signal,), (), 0, 30_000 * MS, MS)
    with pytest.raises(ExperimentError, match="s changes 30001 times in the run; at most 20000"):
        sequence_block(signal, system)
