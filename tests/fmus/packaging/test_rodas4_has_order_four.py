"""RODAS4 in C: halving the step divides the error by 16; the error test holds the tolerance."""

import ctypes
import re
import subprocess

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmus.packaging.compiler import FLAGS, find_compiler
from fmus.packaging.plant.codegen import RUNTIME
from fmus.packaging.plant.portable_parts import rodas4

DRIVER = r"""
#include "rodas4.c"

/* x' = y, y' = 2 (1 - x^2) y - x */
static void derivatives(const void *context, const double *x, double *dx) {
    (void)context;
    dx[0] = x[1];
    dx[1] = 2.0 * (1.0 - x[0] * x[0]) * x[1] - x[0];
}

static void linearise(const void *context, const double *x, double *dx, double *jacobian) {
    derivatives(context, x, dx);
    jacobian[0] = 0.0;
    jacobian[1] = 1.0;
    jacobian[2] = -4.0 * x[0] * x[1] - 1.0;
    jacobian[3] = 2.0 * (1.0 - x[0] * x[0]);
}

__attribute__((visibility("default"))) int run(int steps, double duration, double tolerance,
                                               double *x) {
    static const double scale[] = {1.0, 1.0};
    double work[RODAS4_WORK(2)];
    size_t pivots[2];
    Rodas4 solver = {2, NULL, derivatives, linearise, tolerance, scale, work, pivots};
    Rodas4Report report;
    int substeps = 0;
    for (int k = 0; k < steps; k++) {
        double substep = duration / steps;
        if (rodas4_integrate(&solver, duration / steps, x, &substep, &report) != RODAS4_DONE) {
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
    folder = tmp_path_factory.mktemp("rodas4")
    source, library = folder / "driver.c", folder / "driver.so"
    source.write_text(DRIVER)
    compiler = find_compiler()
    assert compiler is not None
    command = [*compiler.command, *FLAGS, f"-I{RUNTIME}", str(source), "-o", str(library), "-lm"]
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
    """With a tolerance beyond reach every step is one substep of fixed size."""
    errors = []
    for steps in (40, 80, 160, 320):
        x, substeps = end_state(driver, steps, 1e9)
        assert substeps == steps
        errors.append(np.abs(x - exact).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders >= 3.8) and abs(orders[-1] - 4.0) <= 0.15, orders


def test_the_error_test_controls_the_substeps(driver: ctypes.CDLL, exact: np.ndarray) -> None:
    """Error of order 4, estimate of order 3: substeps grow as tolerance^(-1/4)."""
    counts = []
    for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
        x, substeps = end_state(driver, 1, tolerance)
        assert np.abs(x - exact).max() <= 30 * tolerance
        counts.append(substeps)
    growth = np.log10(np.array(counts[1:]) / counts[:-1]) / 2
    assert abs(growth[-1] - 0.25) <= 0.03, counts


def test_the_portable_solver_takes_the_same_coefficients() -> None:
    """Every coefficient of the Python solver stands in the C source, to the last digit."""
    text = (RUNTIME / "rodas4.c").read_text()
    numbers = {float(number) for number in re.findall(r"-?\d\.\d+e[+-]\d\d", text)}
    for table in (rodas4.A, rodas4.C):
        for row in table:
            assert {value for value in row if value != 1.0} <= numbers
