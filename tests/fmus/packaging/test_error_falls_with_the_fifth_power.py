"""The native solver: half the step leaves a 32nd of the error; the error test keeps its word."""

import ctypes
import subprocess

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmus.packaging.compiler import FLAGS, find_compiler
from fmus.packaging.plant.codegen import source_files
from fmus.packaging.plant.expressions import plant_expressions
from tests.fmus.packaging.plants import van_der_pol

DRIVER = r"""
#include "model.c"
#include "rodas5p.c"

__attribute__((visibility("default"))) int run(int steps, double duration, double tolerance,
                                               double *x) {
    static const double u[] = {0.0}, mu[] = {2.0};
    double invariants[N_INVARIANTS + 1];
    const Rodas5p solver = {u, mu, invariants, tolerance};
    Rodas5pReport report;
    int substeps = 0;
    model_invariants(u, mu, invariants);
    for (int k = 0; k < steps; k++) {
        double substep = duration / steps;
        if (rodas5p_integrate(&solver, duration / steps, x, &substep, &report) != RODAS5P_DONE) {
            return -1;
        }
        substeps += (int)report.accepted;
    }
    return substeps;
}
"""
START = (2.0, 0.5)
DURATION = 1.0


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    folder = tmp_path_factory.mktemp("rodas5p")
    for name, text in source_files(plant_expressions(van_der_pol), 3, "").items():
        (folder / name).write_bytes(text)
    source, library = folder / "driver.c", folder / "driver.so"
    source.write_text(DRIVER)
    compiler = find_compiler()
    assert compiler is not None
    command = [*compiler.command, *FLAGS, str(source), "-o", str(library), "-lm"]
    subprocess.run(command, check=True)
    loaded = ctypes.CDLL(str(library))
    loaded.run.argtypes = [ctypes.c_int, ctypes.c_double, ctypes.c_double, ctypes.c_void_p]
    return loaded


def end_state(driver: ctypes.CDLL, steps: int, tolerance: float) -> tuple[np.ndarray, int]:
    x = np.array(START)
    return x, driver.run(steps, DURATION, tolerance, x.ctypes.data)


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    def f(_t: float, x: np.ndarray) -> list[float]:
        return [x[1], 2 * (1 - x[0] ** 2) * x[1] - x[0]]

    solution = solve_ivp(f, (0, DURATION), START, "DOP853", rtol=1e-13, atol=1e-14)
    return np.asarray(solution.y[:, -1])


def test_halving_the_step(driver: ctypes.CDLL, exact: np.ndarray) -> None:
    """With a tolerance beyond reach every step is one substep of fixed size; of the next order much
    is left at these sizes."""
    errors = []
    for steps in (20, 40, 80, 160):
        x, substeps = end_state(driver, steps, 1e9)
        assert substeps == steps
        errors.append(np.abs(x - exact).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders >= 4.9), orders


def test_the_error_test_controls_the_substeps(driver: ctypes.CDLL, exact: np.ndarray) -> None:
    """The estimate has order 4: substeps grow as tolerance^(-1/5)."""
    counts = []
    for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
        x, substeps = end_state(driver, 1, tolerance)
        assert np.abs(x - exact).max() <= 10 * tolerance
        counts.append(substeps)
    growth = np.log10(np.array(counts[1:]) / counts[:-1]) / 2
    assert abs(growth[-1] - 0.2) <= 0.03, counts
