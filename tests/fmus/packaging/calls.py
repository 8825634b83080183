"""Arguments for the functions in the tables of the standard, for a plant with one state."""

from __future__ import annotations

from ctypes import byref, c_bool, c_double, c_int, c_size_t, c_uint, c_void_p, create_string_buffer
from types import SimpleNamespace
from typing import Any

from fmus.declaration import Parameter, State, Variable
from fmus.plant import Plant
from tests.fmus.packaging.raw import OK, Raw


def _equations(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Any:
    return {"state": p.tunable * x.state**2 + u.input}, {"output": p.fixed * x.state + u.input}


everything = Plant(
    name="everything",
    description="One variable of each kind; a step over 2 s from the start values escapes",
    states=(State("state", "1", "x", 1.0, 1.0),),
    inputs=(Variable("input", "1", "u"),),
    outputs=(Variable("output", "1", "y"),),
    parameters=(
        Parameter("tunable", "1", "gain", 1.0, "test"),
        Parameter("fixed", "1", "scale", 1.0, "test", tunable=False),
    ),
    equations=_equations,
)


def try_call(fmu: Raw, name: str) -> int:
    """The status of a call with arguments that nothing can be said against."""
    if name == "EnterInitializationMode" and fmu.version == 3:
        return fmu.enter_initialization()
    if name == "DoStep":
        return fmu.step(0.0, 0.01)
    if name == "GetFMUState":
        return _store_and_restore(fmu)
    return fmu.call("GetReal" if name == "Get" and fmu.version == 2 else
                    "GetFloat64" if name == "Get" else name, *_arguments(fmu, name))  # fmt: skip


def _arguments(fmu: Raw, name: str) -> tuple[Any, ...]:
    one, number = c_size_t(1), (c_double * 1)(1.0)
    result, order = (c_double * 1)(), (c_int * 1)(1)
    more = (one,) if fmu.version == 3 else ()
    flag = byref(c_bool()) if fmu.version == 3 else byref(c_int())

    def vr(variable: str) -> Any:
        return (c_uint * 1)(fmu.references[variable])

    derivative = (vr("output"), one, vr("state"), one, number, *more, result, *more)
    return {
        "SetDebugLogging": (c_bool(True) if more else c_int(1), c_size_t(0), None),
        "SetupExperiment": (c_int(0), c_double(0), c_double(0), c_int(0), c_double(0)),
        "Get": (vr("output"), one, result, *more),
        "GetDirectionalDerivative": derivative,
        "GetAdjointDerivative": derivative,
        "NewDiscreteStates": (create_string_buffer(64),),
        "UpdateDiscreteStates": (*[byref(c_bool()) for _ in range(5)], byref(c_double())),
        "CompletedIntegratorStep": (c_bool(True) if more else c_int(1), flag, flag),
        "SetTime": (c_double(0.0),),
        "SetContinuousStates": (number, one),
        "GetRealOutputDerivatives": (vr("output"), one, order, result),
        "GetOutputDerivatives": (vr("output"), one, order, result, one),
    }.get(name, (result, one) if name.endswith(("States", "Derivatives")) else ())


def _store_and_restore(fmu: Raw) -> int:
    state, word = c_void_p(), "FMUState" if fmu.version == 3 else "FMUstate"
    status = fmu.call(f"Get{word}", byref(state))
    if status == OK:
        status = fmu.call(f"Set{word}", state)
        assert fmu.call(f"Free{word}", byref(state)) == OK
    return status
