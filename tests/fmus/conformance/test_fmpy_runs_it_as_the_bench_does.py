"""FMPy's `simulate_fmu` and our loop come to the same numbers, in both kinds of interface."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from fmpy import simulate_fmu
from numpy.typing import NDArray

from harness.fmi.fmu import Fmu
from tests.fmus.conformance.excitation import STEP, STOP_TIME, Excited, held_signals

ME_SHARE = 1e-6
Array = NDArray[np.float64]


def columns(values: Sequence[Array], rows: int) -> Array:
    """Values side by side, shape (rows, len(values)), also where there are none."""
    return np.array(values).reshape(len(values), rows).T


def fmpy_run(
    fmu: Path, run: Excited, kind: str, names: list[str], tolerance: float | None
) -> Array:
    """Rows of `names` at the communication points, shape (rows, len(names))."""
    result = simulate_fmu(
        str(fmu),
        fmi_type=kind,
        stop_time=STOP_TIME,
        output_interval=STEP,
        relative_tolerance=tolerance,
        input=held_signals(run.plant, run),
        output=names,
        record_events=False,
    )
    assert np.array_equal(result["time"], run.result.time)
    return columns([result[name] for name in names], len(result))


def without_feedthrough(fmu: Path) -> list[str]:
    """Outputs that do not jump with an input: those are the same before and after it is set."""
    with Fmu(fmu) as opened:
        feedthrough = opened.description.feedthrough
    return [name for name, inputs in feedthrough.items() if inputs == ()]


def test_co_simulation_to_the_last_bit(fmu: Path, excited: Excited) -> None:
    names = [state.name for state in excited.plant.states] + without_feedthrough(fmu)
    rows = len(excited.result.time)
    expected = columns([excited.result[f"plant.{name}"] for name in names], rows)
    found = fmpy_run(fmu, excited, "CoSimulation", names, None)
    assert np.array_equal(found, expected)


def test_model_exchange_within_the_solvers_tolerance(
    fmu: Path, excited: Excited, exact: Array
) -> None:
    """CVode integrates the FMU's equations; it is held to the reference as our solver is."""
    names = [state.name for state in excited.plant.states]
    found = fmpy_run(fmu, excited, "ModelExchange", names, 1e-10)
    span = np.ptp(exact, axis=0)
    assert np.all(np.abs(found - exact) <= ME_SHARE * span)
    assert np.all(np.abs(found - excited.states) <= 1e-5 * span)
