"""What the standards allow in which state, as tables: x where a call must be taken.

FMI 2: the tables of sections 3.2.3 and 4.2.4 of the standard, version 2.0.5, with the footnotes
that say which variables may be set. FMI 3: "Allowed Function Calls" of sections 2.3, 3.2 and 4.2 of
version 3.0.2. Functions that ask for a capability that no FMU of ours declares are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

from tests.fmus.packaging.raw import CO_SIMULATION, MODEL_EXCHANGE

# Taken where the standard leaves it undefined: nothing is spoiled, and importers do it.
LENIENT = {
    ("SetTime", "event"),
    ("GetNominalsOfContinuousStates", "instantiated"),
    ("GetNominalsOfContinuousStates", "initialization"),
    ("Terminate", "failed"),
    ("input", "instantiated"),  # FMI 2 gives inputs no `initial`, start values are set all the same
    ("tunable", "continuous"),  # importers that evaluate functions of (x, u, p) set all of them
}


@dataclass(frozen=True)
class Table:
    """The states in the order of the columns, and per row (function or kind of variable) a mark."""

    version: int
    kind: str
    states: tuple[str, ...]
    functions: dict[str, str]
    settable: dict[str, str]

    def cells(self, rows: dict[str, str]) -> list[tuple[str, str, bool]]:
        """(row, state, whether it is allowed)."""
        return [
            (row, state, mark == "x")
            for row, marks in rows.items()
            for state, mark in zip(self.states, marks, strict=True)
        ]


ALWAYS = ("SetDebugLogging", "Reset", "GetFMUState")
EXCHANGE = ("instantiated", "initialization", "event", "continuous", "terminated")
STEPPING = ("instantiated", "initialization", "step", "failed", "terminated")
TABLES = (
    Table(2, MODEL_EXCHANGE, EXCHANGE, {
        **dict.fromkeys(ALWAYS, "xxxxx"),
        "SetupExperiment": "x....",
        "EnterInitializationMode": "x....",
        "ExitInitializationMode": ".x...",
        "Terminate": "..xx.",
        "Get": ".xxxx",
        "GetDirectionalDerivative": ".xxxx",
        "EnterEventMode": "..xx.",
        "NewDiscreteStates": "..x..",
        "EnterContinuousTimeMode": "..x..",
        "CompletedIntegratorStep": "...x.",
        "SetTime": "...x.",
        "SetContinuousStates": "...x.",
        "GetContinuousStates": ".xxxx",
        "GetDerivatives": ".xxxx",
        "GetNominalsOfContinuousStates": "xxxxx",
    }, {"state": "xx.x.", "input": ".xxx.", "tunable": "xxx..", "fixed": "xx...",
        "output": ".....", "derivative": ".....", "time": "....."}),
    Table(2, CO_SIMULATION, STEPPING, {
        **dict.fromkeys(ALWAYS, "xxxxx"),
        "SetupExperiment": "x....",
        "EnterInitializationMode": "x....",
        "ExitInitializationMode": ".x...",
        "Terminate": "..xx.",
        "Get": ".xxxx",
        "GetDirectionalDerivative": ".xxxx",
        "GetRealOutputDerivatives": "..xxx",
        "DoStep": "..x..",
    }, {"state": "xx...", "input": ".xx..", "tunable": "xxx..", "fixed": "xx...",
        "output": ".....", "derivative": ".....", "time": "....."}),
    Table(3, MODEL_EXCHANGE, EXCHANGE, {
        **dict.fromkeys(ALWAYS, "xxxxx"),
        "EnterInitializationMode": "x....",
        "ExitInitializationMode": ".x...",
        "Terminate": "..xx.",
        "Get": "xxxxx",
        "GetDirectionalDerivative": ".xxxx",
        "GetAdjointDerivative": ".xxxx",
        "EnterEventMode": "...x.",
        "UpdateDiscreteStates": "..x..",
        "EnterContinuousTimeMode": "..x..",
        "CompletedIntegratorStep": "...x.",
        "SetTime": "...x.",
        "SetContinuousStates": "...x.",
        "GetContinuousStates": ".xxxx",
        "GetContinuousStateDerivatives": ".xxxx",
        "GetNominalsOfContinuousStates": "..xxx",
    }, {"state": "xxxx.", "input": "xxxx.", "tunable": "xxx..", "fixed": "xx...",
        "output": ".....", "derivative": ".....", "time": "....."}),
    Table(3, CO_SIMULATION, STEPPING, {
        **dict.fromkeys(ALWAYS, "xxxxx"),
        "EnterInitializationMode": "x....",
        "ExitInitializationMode": ".x...",
        "Terminate": "..x..",
        "Get": "xxxxx",
        "GetDirectionalDerivative": ".xxxx",
        "GetAdjointDerivative": ".xxxx",
        "GetOutputDerivatives": "..xxx",
        "DoStep": "..x..",
    }, {"state": "xx...", "input": "xxx..", "tunable": "xxx..", "fixed": "xx...",
        "output": ".....", "derivative": ".....", "time": "....."}),
)  # fmt: skip
