"""What modelDescription.xml says: dependencies, units, capabilities, names."""

from dataclasses import replace
from xml.etree import ElementTree

import pytest
from fmpy import read_model_description
from fmpy.model_description import ModelDescription

from fmus.declaration import Variable
from fmus.packaging.errors import PackagingError
from fmus.packaging.plant.build import cached_fmu
from fmus.packaging.plant.native import native_content
from fmus.plant import Plant
from tests.fmus.packaging.plants import finite_escape, hydraulic, oscillator, static_gain


def described(plant: Plant, version: int) -> ModelDescription:
    return read_model_description(str(cached_fmu(plant, version)))


def dependencies(unknowns: list) -> dict[str, dict[str, str]]:
    return {
        u.variable.name: {
            d.name: kind for d, kind in zip(u.dependencies, u.dependenciesKind, strict=True)
        }
        for u in unknowns
    }


def test_run_time_dependencies_of_the_oscillator(version: int) -> None:
    """Linear in states and input; mass is fixed, stiffness and damping tunable."""
    model = described(oscillator, version)
    rate = {"position": "tunable", "velocity": "tunable", "force": "fixed"}
    assert dependencies(model.derivatives) == {
        "der(position)": {"velocity": "constant"},
        "der(velocity)": rate,
    }
    assert dependencies(model.outputs) == {
        "position": {},
        "spring_force": {"position": "tunable"},
        "acceleration": rate,
    }


def test_initial_unknowns_depend_on_parameters_too(version: int) -> None:
    found = dependencies(described(oscillator, version).initialUnknowns)
    assert found["spring_force"] == {"position": "dependent", "stiffness": "dependent"}
    assert set(found["acceleration"]) == {
        "position", "velocity", "force", "mass", "damping", "stiffness"
    }  # fmt: skip
    assert found["der(position)"] == {"velocity": "constant"}
    assert "position" not in found


def test_a_product_depends_on_both_factors(version: int) -> None:
    found = dependencies(described(static_gain, version).outputs)
    assert found == {
        "product": {"a": "dependent", "b": "dependent"},
        "sum": {"a": "constant", "b": "constant"},
    }


def test_states_are_set_by_their_start_and_outputs_follow(version: int) -> None:
    variables = {v.name: v for v in described(oscillator, version).modelVariables}
    position, velocity = variables["position"], variables["velocity"]
    assert (position.causality, position.initial, float(position.start)) == ("output", "exact", 0.1)
    assert (velocity.causality, velocity.initial, float(velocity.start)) == ("local", "exact", 0.0)
    assert variables["der(velocity)"].derivative is velocity
    assert variables["mass"].variability == "fixed"
    assert (float(variables["stiffness"].min), float(variables["stiffness"].max)) == (0.0, 1e4)
    assert variables["time"].causality == "independent"


def test_units_carry_exponents_factor_and_display_units(version: int) -> None:
    units = {unit.name: unit for unit in described(hydraulic, version).unitDefinitions}
    pascal = units["Pa"]
    assert (pascal.baseUnit.kg, pascal.baseUnit.m, pascal.baseUnit.s) == (1, -1, -2)
    (bar,) = pascal.displayUnits
    assert (bar.name, float(bar.factor)) == ("bar", 1e-5)
    assert units["Pa/s"].baseUnit.s == -3
    leakage = units["m3/(s.Pa)"].baseUnit
    assert (leakage.kg, leakage.m, leakage.s) == (-1, 4, 1)


def test_capabilities_and_experiment(version: int) -> None:
    model = described(oscillator, version)
    slave = model.coSimulation
    assert slave.canGetAndSetFMUstate and slave.canSerializeFMUstate
    assert slave.canHandleVariableCommunicationStepSize
    assert slave.maxOutputDerivativeOrder == 1 and not slave.canInterpolateInputs
    experiment = model.defaultExperiment
    values = (experiment.stopTime, experiment.stepSize, experiment.tolerance)
    assert tuple(map(float, values)) == (1.0, 0.01, 1e-6)


def test_partial_derivatives_are_declared_in_both_interfaces(version: int) -> None:
    """Read from the XML itself: FMPy overlooks FMI 3's attribute."""
    root = ElementTree.fromstring(native_content(oscillator, version).files["modelDescription.xml"])
    for kind in ("ModelExchange", "CoSimulation"):
        attributes = root.find(kind).attrib
        if version == 2:
            assert attributes["providesDirectionalDerivative"] == "true"
        else:
            assert attributes["providesDirectionalDerivatives"] == "true"
            assert attributes["providesAdjointDerivatives"] == "true"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"name": "two words"}, "no identifier"),
        ({"outputs": (Variable("x", "1", "not the state"),)}, "missing"),
        ({"inputs": (Variable("x", "1", "name of the state"),)}, "more than one"),
        ({"outputs": (Variable("y", "furlong", ""),)}, "furlong"),
        ({"equations": lambda x, u, p: ({"x": x.x}, {})}, r"missing \['y'\]"),
    ],
)
def test_unsound_plants_are_refused(change: dict, words: str, version: int) -> None:
    with pytest.raises(PackagingError, match=words):
        native_content(replace(finite_escape, **change), version)
