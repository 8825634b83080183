"""FMPy as a peer: where it can simulate, its rows and ours agree; what it refuses, runs here."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import simulate_fmu

from harness import registry, simulate
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler
STOP = 1.0


def peer(path: Path, kind: str, **more: Any) -> Any:
    return simulate_fmu(
        str(path), fmi_type=kind, stop_time=STOP, output_interval=0.1, validate=False, **more
    )


def test_co_simulation_with_inputs_and_start_values_is_equal_to_the_bit() -> None:
    path = registry.plant_fmu("two_mass_drive", 2)
    from harness import Fmu

    with Fmu(path) as fmu:
        name = fmu.description.inputs[0].name
    signal = np.array([(0.0, 0.0), (0.4, 1.0), (1.0, 1.0)], dtype=[("time", float), (name, float)])
    theirs = peer(path, "CoSimulation", input=signal)
    ours = simulate(path, stop_time=STOP, step_size=0.1, inputs={
        name: ([0.0, 0.4, 1.0], [0.0, 1.0, 1.0])})  # fmt: skip
    assert list(ours.time) == pytest.approx(list(theirs["time"]), abs=1e-15)
    for column in ours.names:
        assert np.allclose(ours[column], theirs[column], rtol=1e-12, atol=1e-300), column


def test_model_exchange_agrees_within_the_tolerance() -> None:
    path = registry.plant_fmu("two_mass_drive", 3)
    theirs = peer(path, "ModelExchange", relative_tolerance=1e-8, start_values={})
    ours = simulate(path, interface_type="me", stop_time=STOP, output_interval=0.1,
                    relative_tolerance=1e-8)  # fmt: skip
    rows = np.isclose(theirs["time"][:, None], ours.time[None, :], atol=1e-12).argmax(axis=1)
    for column in ours.names:
        scale = max(np.abs(theirs[column]).max(), 1e-9)
        assert np.abs(ours[column][rows] - theirs[column]).max() < 1e-5 * scale, column


def test_missing_optional_functions_are_no_reason_to_refuse() -> None:
    """The test FMU has no fmi2GetFMUstate and others; FMPy refuses it at load."""
    with pytest.raises(Exception, match="fmi2"):
        peer(model_fmu("2"), "CoSimulation")
    assert simulate(model_fmu("2"), stop_time=STOP).time[-1] == STOP


def test_a_status_of_fmi_1_other_than_ok_is_no_reason_to_crash() -> None:
    """The test FMU answers every step with Warning, which FMPy 0.3.32 takes for a string."""
    assert simulate(model_fmu("1-slave"), stop_time=STOP).time[-1] == STOP
