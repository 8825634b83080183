"""Whatever changes a bit of a run makes it another run, which the checkpoint is not for; and a run
whose participants remember what cannot be saved has none."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.bench import Bench
from harness.master.opened import opened
from harness.master.run import plan_system
from harness.process.checkpoint import differences, made_of, why_not
from harness.system.graph import Component, FmuComponent
from tests.harness.fmi.archives import rewritten
from tests.hostile.build import description, hostile_fmu
from tests.hostile.worlds import bench

EVENTS = 'hasEventMode="true" canGetAndSetFMUState'


@pytest.mark.parametrize("place", [0, 1500, 2999])
@pytest.mark.parametrize("change", [1e-15, 1.0])
def test_each_number_of_a_long_array_counts(tmp_path: Path, place: int, change: float) -> None:
    """Which numpy does not show, neither the numbers in the middle nor the last digits."""
    system = bench(tmp_path).system()
    with opened(system) as fmus:
        plan = plan_system(system, fmus)

    def given(values: Any) -> dict[str, str]:
        def moved(component: Component) -> Component:
            if isinstance(component, FmuComponent):
                return replace(component, start_values={"T": (values, "m")})
            return component

        components = tuple(map(moved, plan.lowered.components))
        return made_of(replace(plan, lowered=replace(plan.lowered, components=components)), {})

    values = np.linspace(0.1, 0.9, 3000)
    other = values.copy()
    other[place] += change
    assert given(values) == given(values.copy())
    assert differences(given(values), given(other)) == ["component plant"]


def reason(made: Bench) -> str:
    system = made.system()
    with opened(system) as fmus:
        return why_not(plan_system(system, fmus), fmus)


@pytest.mark.parametrize("event_mode", [None, True, False])
def test_event_mode_is_refused(tmp_path: Path, event_mode: bool | None) -> None:
    document = description(3).replace("canGetAndSetFMUState", EVENTS).encode()
    fmu = rewritten(hostile_fmu(tmp_path), tmp_path / "e.fmu", modelDescription_dot_xml=document)
    made = Bench(stop_time=1.0, step=0.01)
    made.fmu("plant", fmu, event_mode=event_mode)
    assert ("is run with event mode" in reason(made)) == (event_mode is not False)


def test_model_exchange_is_refused(tmp_path: Path) -> None:
    assert reason(bench(tmp_path)) == ""
    made = Bench(stop_time=1.0, step=0.01)
    made.fmu("left", "oscillator_left", interface_type="model-exchange")
    assert "component left is run in model-exchange" in reason(made)
