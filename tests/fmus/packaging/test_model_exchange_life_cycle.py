"""Model exchange by hand: modes, states, nominals, derivatives, in the order of the standard."""

from ctypes import byref, c_double, c_size_t
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model

from fmus.packaging.plant.build import cached_fmu
from tests.fmus.packaging.plants import oscillator

X = [0.25, -0.5]


@pytest.fixture
def model(version: int, tmp_path: Path) -> Any:
    path = str(cached_fmu(oscillator, version))
    description = read_model_description(path)
    extract(path, unzipdir=str(tmp_path))
    fmu_class = FMU3Model if version == 3 else FMU2Model
    fmu = fmu_class(
        guid=description.guid if version == 2 else description.instantiationToken,
        unzipDirectory=str(tmp_path),
        modelIdentifier="oscillator",
        instanceName="instance",
    )
    fmu.instantiate()
    if version == 2:
        fmu.setupExperiment()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    yield fmu
    fmu.freeInstance()


def derivatives(model: Any, version: int) -> list[float]:
    dx = (c_double * 2)()
    get = model.getContinuousStateDerivatives if version == 3 else model.getDerivatives
    get(dx, 2)
    return list(dx)


def discrete_update(model: Any, version: int) -> list[Any]:
    return list(model.updateDiscreteStates() if version == 3 else model.newDiscreteStates())


def test_event_iteration_asks_for_nothing(model: Any, version: int) -> None:
    assert not any(discrete_update(model, version))


def test_states_set_in_continuous_time_mode_are_seen_at_once(model: Any, version: int) -> None:
    model.enterContinuousTimeMode()
    model.setTime(0.5)
    model.setContinuousStates((c_double * 2)(*X), 2)
    force = 3.0
    set_real = model.setFloat64 if version == 3 else model.setReal
    set_real([5], [force])
    expected = [X[1], (force - 1.5 * X[1] - 80.0 * X[0]) / 2.0]
    assert np.allclose(derivatives(model, version), expected, rtol=1e-15, atol=0)
    back = (c_double * 2)()
    model.getContinuousStates(back, 2)
    assert list(back) == X
    nominals = (c_double * 2)()
    model.getNominalsOfContinuousStates(nominals, 2)
    assert list(nominals) == [0.1, 1.0]
    assert list(model.completedIntegratorStep()) == [False, False]


def test_parameters_change_in_event_mode(model: Any, version: int) -> None:
    set_real = model.setFloat64 if version == 3 else model.setReal
    model.enterContinuousTimeMode()
    model.enterEventMode()
    set_real([10], [90.0])
    model.enterContinuousTimeMode()
    assert derivatives(model, version)[1] == -90.0 * 0.1 / 2.0


def test_derivatives_that_are_not_finite_are_discarded(model: Any, version: int) -> None:
    """The solver may then try a shorter step, with other states."""
    model.enterContinuousTimeMode()
    model.setContinuousStates((c_double * 2)(1e308, 1e308), 2)
    with pytest.raises(FMICallException, match="2"):
        derivatives(model, version)
    model.setContinuousStates((c_double * 2)(*X), 2)
    assert np.isfinite(derivatives(model, version)).all()


def test_states_of_event_mode_are_not_set(model: Any) -> None:
    with pytest.raises(FMICallException):
        model.setContinuousStates((c_double * 2)(*X), 2)


def test_wrong_length_is_refused(model: Any, version: int) -> None:
    model.enterContinuousTimeMode()
    for n in (0, 1, 3):
        with pytest.raises(FMICallException):
            model.setContinuousStates((c_double * 3)(), n)


def test_there_are_no_event_indicators(model: Any, version: int) -> None:
    model.getEventIndicators((c_double * 1)(), 0)
    if version == 3:
        n = c_size_t(99)
        model.fmi3GetNumberOfEventIndicators(model.component, byref(n))
        assert n.value == 0
        model.fmi3GetNumberOfContinuousStates(model.component, byref(n))
        assert n.value == 2
