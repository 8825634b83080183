"""The loop says which FMUs it does not run, and what does."""

import pytest

from harness import Bench
from harness.errors import HarnessError
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler


def test_fmi_1_is_named_with_the_way_out() -> None:
    bench = Bench(stop_time=0.1, step=0.1)
    bench.fmu("plant", model_fmu("1-slave"))
    with pytest.raises(HarnessError, match=r"plant: its FMU is of FMI 1.*`fmu-harness simulate`"):
        bench.run()


def test_an_fmu_for_model_exchange_only_says_so() -> None:
    bench = Bench(stop_time=0.1, step=0.1)
    bench.fmu("plant", model_fmu("1-model"))
    with pytest.raises(HarnessError, match=r"its FMU is of FMI 1|offers no co-simulation"):
        bench.run()
