"""CasADi's DaeBuilder loads every native FMU and finds the plant's own derivatives in it."""

import zipfile
from pathlib import Path

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from fmus.packaging.plant.functions import plant_functions
from fmus.plant import Plant


def test_rates_outputs_and_jacobian(plant: Plant, fmu: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path)
    dae = ca.DaeBuilder(plant.name, str(tmp_path), {"debug": False})
    own = plant_functions(plant)
    tunable = [p.value for p in plant.parameters if p.name in dae.p()]
    x = own.x_start + 1e-3 * np.array([s.nominal for s in plant.states])
    u = own.u_start + 1e-3 * np.array([v.nominal for v in plant.inputs])
    assert dae.u() == [v.name for v in plant.inputs]

    def close(found: ca.DM, expected: ArrayLike) -> None:
        wanted = np.asarray(expected).reshape(found.shape)
        np.testing.assert_allclose(found.full(), wanted, rtol=1e-12, atol=1e-12)

    if plant.states:
        evaluate = dae.create("evaluate", ["x", "u", "p"], ["ode", "y", "jac_ode_x"])
        rates, outputs, jacobian = evaluate(x, u, tunable)
        close(rates, own.f(x, u))
        close(jacobian, own.f_x(x, u))
    else:
        outputs = dae.create("evaluate", ["u", "p"], ["y"])(u, tunable)
    close(outputs, own.h(x, u))
