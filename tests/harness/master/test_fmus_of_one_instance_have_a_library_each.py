"""An FMU that may be instantiated once in a process runs twice in one system by two libraries."""

from pathlib import Path

import numpy as np
import pytest

from harness.bench import Bench
from harness.results.result import Result
from tests.harness.inspection.liars import liar

ONCE = 'canBeInstantiatedOnlyOncePerProcess="true"'


def run(fmu: Path) -> Result:
    """Two lags in a row, the first one driven by a step."""
    bench = Bench(stop_time=1.0, step=0.1)
    bench.signal("reference", "step", time=0.0, final=1.0)
    bench.fmu("a", fmu)
    bench.fmu("b", fmu)
    bench.connect("reference", "a.u")
    bench.connect("a.y", "b.u")
    return bench.run()


@pytest.mark.filterwarnings("ignore")
def test_instances_of_a_library_with_static_state_do_not_meet(tmp_path: Path) -> None:
    (tmp_path / "honest").mkdir()
    honest = run(liar(tmp_path / "honest"))
    shared = run(liar(tmp_path, "SHARED", capabilities=ONCE))
    assert np.ptp(honest["b.y"]) > 0.1
    for name in ("a.y", "b.y"):
        np.testing.assert_array_equal(shared[name], honest[name])


@pytest.mark.filterwarnings("ignore")
def test_without_the_flag_they_share_it(tmp_path: Path) -> None:
    shared = run(liar(tmp_path, "SHARED"))
    np.testing.assert_array_equal(shared["a.y"], shared["b.y"])
