"""The compiled loop and a plain Python execution of the same program give the same bits, with
imperfections, noise, units, Python controllers and compiled blocks on the way."""

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from harness.instruments.imperfections import make_imperfection
from harness.master.program.frame import Frame
from tests.harness.master import reference_executor
from tests.harness.master.random_systems import Case, systems
from tests.harness.master.rows import run_to_end

ON_WIRES = (
    (),
    (make_imperfection("noise", {"std": 0.25}),),
    (make_imperfection("quantisation", {"step": 0.125}),),
    (make_imperfection("bias", {"value": 0.5}), make_imperfection("noise", {"std": 0.5})),
)


@st.composite
def imperfect_systems(draw: st.DrawFn) -> Case:
    case = draw(systems())
    wires = tuple(
        replace(wire, imperfections=draw(st.sampled_from(ON_WIRES)))
        for wire in case.system.connections
    )
    return Case(replace(case.system, connections=wires), case.fmus)


@settings(max_examples=40, deadline=None, derandomize=True,
          suppress_health_check=[HealthCheck.function_scoped_fixture])  # fmt: skip
@given(case=imperfect_systems())
def test_same_bits_same_faults(monkeypatch: pytest.MonkeyPatch, case: Case) -> None:
    compiled, first = run_to_end(case.system, case.fmus)
    with monkeypatch.context() as patch:
        patch.setattr(Frame, "run", reference_executor.run)
        interpreted, second = run_to_end(case.system, case.fmus)
    assert str(first.fault) == str(second.fault)
    assert first.end_ns == second.end_ns
    assert compiled.seconds.tobytes() == interpreted.seconds.tobytes()
    assert compiled.rows.tobytes() == interpreted.rows.tobytes()
    for fmu in case.fmus.values():
        one, other = fmu.instances[-2:]
        assert one.calls == other.calls, "the same functions in the same order"
        assert one.model.steps == other.model.steps
