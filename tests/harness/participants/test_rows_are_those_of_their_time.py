"""In model exchange a variable that an FMU computes with its derivatives alone, as those of
OpenModelica do, is recorded as it is at the time of the row, wherever the solver looked last."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from tests.harness.simulation.fmus import compiled, needs_compiler

pytestmark = needs_compiler

SOURCE = r"""
#include <stdlib.h>
typedef struct { double t, x, y; } model;
void *fmi2Instantiate(const char *n, int k, const char *g, const char *w, const void *f, int v,
                      int l) { model *m = calloc(1, sizeof(model)); m->x = 1; return m; }
void fmi2FreeInstance(void *m) { free(m); }
int fmi2SetupExperiment(void *m, int d, double t, double a, int e, double b) { return 0; }
int fmi2EnterInitializationMode(void *m) { return 0; }
int fmi2ExitInitializationMode(void *m) { return 0; }
int fmi2EnterEventMode(void *m) { return 0; }
int fmi2EnterContinuousTimeMode(void *m) { return 0; }
int fmi2NewDiscreteStates(void *m, int *info) { for (int i = 0; i < 5; i++) info[i] = 0; return 0; }
int fmi2Terminate(void *m) { return 0; }
int fmi2Reset(void *m) { return 0; }
int fmi2SetTime(void *p, double t) { model *m = p; m->t = t; return 0; }
int fmi2SetContinuousStates(void *p, const double *x, size_t n) {
    model *m = p; m->x = x[0]; return 0; }
int fmi2GetContinuousStates(void *p, double *x, size_t n) { model *m = p; x[0] = m->x; return 0; }
int fmi2GetNominalsOfContinuousStates(void *p, double *x, size_t n) { x[0] = 1; return 0; }
int fmi2GetEventIndicators(void *p, double *z, size_t n) { return 0; }
int fmi2GetDerivatives(void *p, double *dx, size_t n) {
    model *m = p; m->y = 2 * m->t; dx[0] = -m->x; return 0; }
int fmi2GetReal(void *p, const unsigned *r, size_t n, double *v) {
    model *m = p;
    for (size_t i = 0; i < n; i++) v[i] = r[i] == 0 ? m->x : r[i] == 1 ? -m->x : m->y;
    return 0; }
int fmi2SetReal(void *p, const unsigned *r, size_t n, const double *v) { return 0; }
"""
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="lazy" guid="1" numberOfEventIndicators="0">
  <ModelExchange modelIdentifier="lazy" completedIntegratorStepNotNeeded="true"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="0" initial="exact"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="der(x)" valueReference="1"><Real derivative="1"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="3"/></Outputs>
    <Derivatives><Unknown index="2"/></Derivatives>
    <InitialUnknowns><Unknown index="2"/><Unknown index="3"/></InitialUnknowns></ModelStructure>
</fmiModelDescription>
"""


@pytest.fixture(scope="module")
def lazy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lazy")
    (folder / "lazy.c").write_text(SOURCE)
    library = compiled(folder / "lazy.c", folder / "lazy.so")
    with zipfile.ZipFile(folder / "lazy.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(library, "binaries/linux64/lazy.so")
    return folder / "lazy.fmu"


@pytest.mark.parametrize("solver", ["cvode", "euler"])
def test_between_the_steps_of_the_solver(lazy: Path, solver: str) -> None:
    result = simulate(
        lazy, stop_time=1.0, step_size=0.07, output_interval=0.01, solver=solver,
        in_process=True,
    )  # fmt: skip
    assert len(result.time) == 101
    assert np.allclose(result["y"][1:], 2 * np.asarray(result.time)[1:], rtol=1e-12)
