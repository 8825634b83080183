"""What the description of a controller's FMU says: clock, units, no feedthrough, all states."""

import zipfile
from html import escape
from inspect import getdoc
from pathlib import Path
from typing import Any

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu
from lxml import etree

from controllers.core.block import Block, Signal
from controllers.pid import pid as pid_module
from harness.errors import FmuError
from harness.export.controller import controller_fmu, identifier
from tests.harness.export.blocks import counter, counter_step, pid


def described(path: Path) -> Any:
    return read_model_description(str(path))


def root(path: Path) -> etree._Element:
    with zipfile.ZipFile(path) as archive:
        return etree.fromstring(archive.read("modelDescription.xml"))


@pytest.mark.parametrize("block", [counter(), pid()], ids=["counter", "pid"])
def test_the_validator_is_silent(block: Block, version: int) -> None:
    assert validate_fmu(str(controller_fmu(block, "block", 0.01, version))) == []


def test_every_variable_with_its_role(version: int) -> None:
    variables = described(controller_fmu(counter(), "block", 0.01, version)).modelVariables
    assert [(v.name, v.causality, v.variability, v.start, v.unit) for v in variables] == [
        ("time", "independent", "continuous", None, "s"),
        ("u", "input", "continuous", "0.25", "m"),
        ("count", "output", "discrete", "-1.0", "1"),
        ("echo", "output", "discrete", "-2.0", "m"),
        ("parameters.increment", "parameter", "tunable", "1.0", None),
        ("parameters.unused", "local", "constant", "1.7976931348623157e+308", None),
        ("state.count", "local", "discrete", "0.0", None),
    ]


def test_outputs_depend_on_no_input(version: int) -> None:
    outputs = described(controller_fmu(counter(), "block", 0.01, version)).outputs
    assert [(o.variable.name, o.dependencies) for o in outputs] == [("count", []), ("echo", [])]


def test_clock_and_capabilities(version: int) -> None:
    path = controller_fmu(counter(), "block", 0.01, version, description="A counter.")
    description = described(path)
    assert description.modelExchange is None
    assert description.coSimulation.canHandleVariableCommunicationStepSize
    assert description.defaultExperiment.stepSize == "0.01"
    assert description.description.startswith("A counter. Computes every 0.01 s")
    if version == 3:
        (interface,) = root(path).iter("CoSimulation")
        assert interface.get("fixedInternalStepSize") == "0.01"


def test_default_experiment_is_a_hundred_samples(version: int) -> None:
    experiment = described(controller_fmu(counter(), "block", 0.01, version)).defaultExperiment
    assert (experiment.startTime, experiment.stopTime) == ("0", "1.0")
    assert float(experiment.tolerance) > 0


def test_the_page_says_equations_timing_parameters_and_certificate(version: int) -> None:
    with zipfile.ZipFile(controller_fmu(pid(), "block", 0.01, version)) as archive:
        name = "index.html" if version == 3 else "_main.html"
        page = archive.read(f"documentation/{name}").decode()
    assert "Computes every 0.01 s" in page
    assert "parameters.kp" in page
    assert "certificate.json" in page
    assert escape(getdoc(pid_module) or "?") in page


def test_there_are_no_sources_but_what_it_was_made_from(version: int) -> None:
    with zipfile.ZipFile(controller_fmu(counter(), "block", 0.01, version)) as archive:
        names = archive.namelist()
    assert not [name for name in names if name.startswith("sources/")]
    assert {"extra/fmu-harness.build/step.ll", "extra/fmu-harness.build/all.c"} <= set(names)


def test_names_that_no_fmu_can_carry_are_refused() -> None:
    block = Block((Signal("a"),), (Signal("a"), Signal("b")), counter_step)
    with pytest.raises(FmuError, match="'a' is given to more than one variable"):
        controller_fmu(block, "block", 0.01)


def test_a_name_becomes_an_identifier() -> None:
    assert identifier("my-controller 2") == "my_controller_2"
    assert identifier("2nd") == "_2nd"
