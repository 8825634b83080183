"""Initialisation passes outputs on in the order of their dependencies, and keeps start values.

What an FMU input has while the FMU is initialised is seen by a hook on its exit from that mode.
"""

from dataclasses import replace

import pytest

from harness.errors import GraphError
from harness.master.run import plan_system
from harness.system.graph import System
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system, wire


def with_start(one: MockFmu, start: str) -> MockFmu:
    variables = dict(one.description.variables)
    variables["u"] = replace(variables["u"], start=start)
    one.description = replace(one.description, variables=variables)
    return one


def initial_inputs(whole: System, fmus: dict[str, MockFmu]) -> dict[str, float]:
    """The inputs of all FMUs when they leave initialisation mode."""
    seen: dict[str, float] = {}

    def look(instance, name: str) -> None:  # type: ignore[no-untyped-def]
        if name == "Exit":
            values = instance.model.values.items()
            seen.update({f"{instance.name}.{port}": value for port, value in values})

    for one in fmus.values():
        one.hook = look
    run(whole, fmus)
    return seen


def test_a_chain_that_holds_in_the_initialisation_only_is_followed() -> None:
    """b.y depends on b.u only while b is initialised, as a state computed from an input does."""
    fmus = {name: MockFmu(outputs=(Output("y", depends=("u",)),)) for name in ("c", "b")}
    fmus["a"] = MockFmu(state=4.0)
    for name in ("c", "b"):
        fmus[name].description = replace(
            fmus[name].description, feedthrough={"y": ()}, initial_feedthrough={"y": ("u",)}
        )
    chain = system(*map(fmu, fmus), wire("a.y", "b.u"), wire("b.y", "c.u"), stop_ns=10 * MS)
    seen = initial_inputs(chain, fmus)
    assert seen["b.u"] == 4.0 and seen["c.u"] == 1.0 + 4.0 / 8
    # a loop of such dependencies is one, though no step has it
    closed = system(
        *map(fmu, fmus),
        wire("c.y", "b.u"),
        wire("b.y", "c.u"),
        stop_ns=10 * MS,
        algebraic_loops="refuse",
    )
    with pytest.raises(GraphError, match="loop by direct feedthrough during initialisation"):
        plan_system(closed, fmus)  # type: ignore[arg-type]


@pytest.mark.parametrize("delay_ms", [0, 20])
def test_an_input_keeps_its_start_value_until_a_controller_has_computed(delay_ms: int) -> None:
    """3 stands in the model description; the controller's own first value is 100."""
    late = controller(lambda time: 100.0, 20 * MS, phase_ns=10 * MS)
    whole = system(fmu(), late, wire("controller.u", "plant.u", delay_ms * MS))
    fmus = {"plant": with_start(MockFmu(), "3")}
    assert initial_inputs(whole, fmus) == {"plant.u": 3.0}
    rows = run(whole, fmus)
    before = (10 + delay_ms) // 10
    assert rows["plant.u"].tolist() == [3.0] * before + [100.0] * (11 - before)


def test_start_values_of_the_component_and_of_the_block_count_in_this_order_of_meaning() -> None:
    """What a block states is meant; else the user's start value, else the FMU's."""
    wired = wire("controller.u", "plant.u")
    fmus = {"plant": with_start(MockFmu(), "3")}
    for stated, given, expected in ((0.5, {}, 0.5), (0.0, {"u": 7.0}, 7.0), (0.0, {"u": 0}, 0.0)):
        late = controller(lambda time: 1.0, 20 * MS, phase_ns=10 * MS, start=stated)
        seen = initial_inputs(system(fmu(start_values=given), late, wired), fmus)
        assert seen == {"plant.u": expected}


def test_units_are_converted_back() -> None:
    """3 kN at the input are 3000 N at the controller's output."""
    fmus = {"plant": with_start(MockFmu((Input("u", unit="kN"),)), "3")}
    late = controller(lambda time: 1.0, 20 * MS, phase_ns=10 * MS)
    late = replace(late, outputs=(replace(late.outputs[0], unit="N"),))
    units = dict(fmus["plant"].description.units)
    from harness.system.units import Unit

    units["kN"] = Unit("kN", (1, 1, -2, 0, 0, 0, 0, 0), 1000.0, 0.0)
    fmus["plant"].description = replace(fmus["plant"].description, units=units)
    rows = run(system(fmu(), late, wire("controller.u", "plant.u")), fmus)
    assert rows["controller.u"][0] == 3000.0 and rows["plant.u"].tolist()[:2] == [3.0, 1e-3]
