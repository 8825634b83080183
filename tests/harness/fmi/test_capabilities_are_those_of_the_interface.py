"""Each kind of interface has the capabilities that its element states, with the defaults of its
version."""

from pathlib import Path

from harness.fmi.description.model_description import ModelDescription
from harness.fmi.description.reader import read_model_description
from tests.hostile.build import description

FMI1 = """<fmiModelDescription fmiVersion="1.0" modelName="one" modelIdentifier="one" guid="1"
    numberOfContinuousStates="2" numberOfEventIndicators="1"><ModelVariables>
  <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
  <ScalarVariable name="x" valueReference="1" causality="output"><Real/>
    <DirectDependency><Name>u</Name></DirectDependency></ScalarVariable>
  <ScalarVariable name="y" valueReference="1" causality="output" alias="negatedAlias"><Real/>
    </ScalarVariable>
  </ModelVariables>IMPLEMENTATION</fmiModelDescription>"""
SLAVE = """<Implementation><CoSimulation_Tool><Capabilities canInterpolateInputs="true"
    canHandleVariableCommunicationStepSize="true" maxOutputDerivativeOrder="2"/>
    <Model entryPoint="a" type="b"/></CoSimulation_Tool></Implementation>"""


def read(folder: Path, text: str) -> ModelDescription:
    (folder / "modelDescription.xml").write_text(text)
    described, faults = read_model_description(folder, Path("case.fmu"))
    assert faults == ()
    return described


def with_interface(element: str) -> str:
    return description(3).replace("<ModelVariables>", element + "<ModelVariables>")


def test_scheduled_execution(tmp_path: Path) -> None:
    assert read(tmp_path, description(3)).scheduled_execution is None
    element = '<ScheduledExecution modelIdentifier="parts" canGetAndSetFMUState="1"/>'
    found = read(tmp_path, with_interface(element)).scheduled_execution
    assert found is not None and found.model_identifier == "parts"
    assert found.can_get_and_set_fmu_state and not found.can_serialize_fmu_state


def test_co_simulation_of_fmi_3(tmp_path: Path) -> None:
    more = (
        'fixedInternalStepSize="0.5" maxOutputDerivativeOrder="3" hasEventMode="true" '
        'providesIntermediateUpdate="true" canReturnEarlyAfterIntermediateUpdate="true" '
        'recommendedIntermediateInputSmoothness="-1" mightReturnEarlyFromDoStep="true" '
        'needsExecutionTool="true" canBeInstantiatedOnlyOncePerProcess="true"'
    )
    text = description(3).replace("<CoSimulation ", f"<CoSimulation {more} ")
    c = read(tmp_path, text).co_simulation
    assert c is not None and c.fixed_internal_step_size == 0.5
    assert c.max_output_derivative_order == 3 and c.recommended_intermediate_input_smoothness == -1
    assert c.has_event_mode and c.provides_intermediate_update and c.might_return_early
    assert c.can_return_early_after_intermediate_update and c.needs_execution_tool
    assert c.can_be_instantiated_only_once and c.can_handle_variable_step


def test_fmi_1(tmp_path: Path) -> None:
    exchange = read(tmp_path, FMI1.replace("IMPLEMENTATION", ""))
    assert exchange.co_simulation is None and exchange.model_exchange is not None
    assert exchange.number_of_continuous_states == 2 and exchange.number_of_event_indicators == 1
    tool = read(tmp_path, FMI1.replace("IMPLEMENTATION", SLAVE))
    c = tool.co_simulation
    assert c is not None and tool.model_exchange is None
    assert c.can_handle_variable_step and c.can_interpolate_inputs and c.needs_execution_tool
    assert c.max_output_derivative_order == 2


def test_dependencies_and_aliases_of_fmi_1(tmp_path: Path) -> None:
    described = read(tmp_path, FMI1.replace("IMPLEMENTATION", ""))
    assert described.feedthrough == {"x": ("u",), "y": None}
    assert described.variables["y"].details.alias_of == "x"
    assert described.variables["y"].details.negated
    assert described.variables["x"].details.alias_of is None


def test_aliases_of_fmi_2_are_names_of_what_can_be_set(tmp_path: Path) -> None:
    alias = '<ScalarVariable name="same" valueReference="0"><Real/></ScalarVariable>'
    text = description(2).replace("<ModelVariables>", f"<ModelVariables>{alias}", 1)
    text = text.replace('index="2"', 'index="3"')
    variables = read(tmp_path, text).variables
    assert variables["same"].details.alias_of == "u" and not variables["u"].details.alias_of


def test_clocks_of_scheduled_execution(tmp_path: Path) -> None:
    clock = (
        '<Clock name="c" valueReference="9" causality="input" intervalVariability="constant" '
        'intervalDecimal="0.25" priority="2"/>'
        '<Float64 name="d" valueReference="10" clocks="9" variability="discrete" previous="1" '
        'intermediateUpdate="true"/>'
    )
    text = description(3).replace("</ModelVariables>", clock + "</ModelVariables>")
    variables = read(tmp_path, text).variables
    c, d = variables["c"].details, variables["d"].details
    assert (c.interval, c.priority) == (0.25, 2)
    assert (d.clocks, d.previous, d.intermediate_update) == (("c",), "y", True)
