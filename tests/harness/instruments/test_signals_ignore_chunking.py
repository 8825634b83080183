"""A sampler gives the same bits however the sample instants are cut into chunks."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.random import SeedSequence

from harness.instruments.signals import SIGNALS, make_signal
from harness.instruments.source import SignalSource

NOISE = {"kind": "white_noise", "std": 2.0}
EXAMPLES = {
    "constant": {"value": 3},
    "step": {"final": 2, "time": 0.3},
    "multi_step": {"times": [0.1, 0.2], "values": [1, -1]},
    "ramp": {"slope": 2.0, "start_time": 0.1, "end_time": 0.5},
    "sine": {"amplitude": 2.0, "frequency": 3.0, "phase": 0.1},
    "chirp": {"amplitude": 1.0, "start_frequency": 1.0, "end_frequency": 9.0, "duration": 0.4},
    "square": {"amplitude": 1.0, "period": 0.07},
    "pulse": {"amplitude": 1.0, "width": 0.02, "period": 0.07},
    "prbs": {"amplitude": 1.0, "bit_time": 0.013},
    "white_noise": {"std": 1.0},
    "band_limited_noise": {"power": 0.1, "sample_time": 0.017},
    "low_pass_noise": {"std": 1.0, "bandwidth": 5.0},
    "heavy_tailed_noise": {"scale": 1.0},
    "contaminated_noise": {"std": 1.0},
    "uniform": {"low": -1, "high": 1},
    "function": {"function": lambda t: t * t},
    "sum": {"signals": [NOISE, {"kind": "uniform", "low": 0, "high": 1}]},
    "scaled": {"signal": NOISE, "gain": 3.0, "offset": 1.0},
    "windowed": {"signal": NOISE, "start_time": 0.1, "end_time": 0.6},
}


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> dict[str, SignalSource]:
    file: Path = tmp_path_factory.mktemp("csv") / "in.csv"
    file.write_text("time,x\n0,1\n0.25,3\n0.25,4\n0.5,-1\n")
    linear = {"file": file, "column": "x", "interpolation": "linear"}
    made = {kind: make_signal(kind, given) for kind, given in EXAMPLES.items()}
    return made | {"csv": make_signal("csv", linear)}


def test_every_kind_is_tried(sources: dict[str, SignalSource]) -> None:
    assert set(sources) == set(SIGNALS)


@pytest.mark.parametrize("kind", sorted(SIGNALS))
@settings(max_examples=20, deadline=None)
@given(
    gaps=st.lists(st.integers(0, 40_000_000), min_size=1, max_size=60),
    start=st.integers(-10, 10),
    cuts=st.sets(st.integers(0, 60), max_size=8),
    entropy=st.integers(0, 2**32),
)
def test_chunks_do_not_show(
    sources: dict[str, SignalSource],
    kind: str,
    gaps: list[int],
    start: int,
    cuts: set[int],
    entropy: int,
) -> None:
    times = start * 100_000_000 + np.cumsum(np.array(gaps, dtype=np.int64))
    whole = sources[kind].sampler(SeedSequence(entropy)).sample(times)
    assert whole.shape == times.shape
    assert whole.dtype == np.float64
    sampler = sources[kind].sampler(SeedSequence(entropy))
    chunks = np.split(times, sorted(cut for cut in cuts if cut <= len(times)))
    pieces = np.concatenate([sampler.sample(chunk) for chunk in chunks])
    assert pieces.tobytes() == whole.tobytes()
