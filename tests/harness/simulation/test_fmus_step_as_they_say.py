"""An FMU that takes no steps of other sizes is asked for its own; a step of which its internal one
is no divisor is told."""

from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from harness.bench import Bench
from tests.harness.fmi.archives import rewritten
from tests.hostile.build import description, hostile_fmu

VARIABLE = 'canHandleVariableCommunicationStepSize="true"'


def fmu(folder: Path, fmi: int, can: str, step: float = 0.02) -> Path:
    """Discards all steps longer than its own, so that what was asked for is seen."""
    experiment = f'<DefaultExperiment stopTime="0.2" stepSize="{step}"/>'
    text = description(fmi).replace(VARIABLE, can)
    text = text.replace("<ModelVariables>", f"{experiment}<ModelVariables>")
    source = hostile_fmu(folder, f"DoStep too_long 0 {round(1e6 * step) + 1}", fmi=fmi)
    return rewritten(source, folder / "x.fmu", modelDescription_dot_xml=text.encode())


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("interval", [None, 0.1])
def test_its_own_step(tmp_path: Path, fmi: int, interval: float | None) -> None:
    result = simulate(fmu(tmp_path, fmi, ""), output_interval=interval)
    assert np.allclose(np.diff(result.time), interval or 0.02)
    assert not any("discard" in note for note in result.notes)


def test_an_internal_step_that_does_not_fit_is_told(tmp_path: Path) -> None:
    bench = Bench(stop_time=0.1, step=0.01)
    bench.fmu("plant", fmu(tmp_path, 3, f'{VARIABLE} fixedInternalStepSize="0.003"'))
    [note] = bench.run().manifest.notes
    assert (
        "component plant: its FMU computes in steps of 0.003 s, of which its communication" in note
    )
