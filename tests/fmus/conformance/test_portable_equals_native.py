"""The portable FMU follows the native one; each runs in a process of its own kind.

pythonfmu runs inside the interpreter that loads it, so the portable one gets its own process.
"""

from pathlib import Path

import numpy as np

from fmus.plant import Plant
from tests.fmus.conformance.processes import run_python

SHARE = 1e-9


def test_same_numbers(plant: Plant, tmp_path: Path) -> None:
    """Under sines on every input; both solvers take the same substeps."""
    for kind in ("native", "portable"):
        (tmp_path / kind).mkdir()
        fmu = plant.fmu(2, portable=kind == "portable")
        run_python("-m", "tests.fmus.conformance.stored_run", fmu, "store", tmp_path / kind)
    native, portable = (np.load(tmp_path / k / "first.npy") for k in ("native", "portable"))
    assert np.all(np.abs(native - portable) <= SHARE * np.ptp(native, axis=0))
