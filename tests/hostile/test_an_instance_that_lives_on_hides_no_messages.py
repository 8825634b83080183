"""Messages are counted anew for each run, also where an earlier instance was never given back."""

from pathlib import Path

from harness.fmi.binding.logger import MOST_A_RUN, MessageLog, forget, register
from harness.fmi.fmu import Fmu
from tests.hostile.build import hostile_fmu


def test_a_second_run_has_its_own_limit(tmp_path: Path) -> None:
    forgotten = MessageLog()
    register(forgotten)
    try:
        many = MOST_A_RUN[False]
        with Fmu(hostile_fmu(tmp_path, f"DoStep log_many 0 {2 * many}", fmi=3)) as fmu:
            for _ in range(2):
                with fmu.instantiate("a") as instance:
                    instance.enter_initialization_mode(0.0, None, None)
                    instance.exit_initialization_mode()
                    instance.advance(0.0, 0.01)
                    assert instance.log.count == many
    finally:
        forget(forgotten)
