"""Short ways to write down systems of mocks."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from harness.system.block import Port
from harness.system.graph import Connection, Endpoint, FmuComponent, PythonComponent, System

MS = 1_000_000


def end(text: str) -> Endpoint:
    return Endpoint(*text.split("."))


def wire(source: str, target: str, delay_ns: int = 0, *imperfections: Any) -> Connection:
    return Connection(end(source), end(target), delay_ns, imperfections)


def fmu(name: str = "plant", step_ns: int = 10 * MS, **more: Any) -> FmuComponent:
    return FmuComponent(name, Path("mock.fmu"), step_ns, **more)


def controller(
    function: Callable[..., float],
    period_ns: int = 10 * MS,
    phase_ns: int = 0,
    name: str = "controller",
    start: float = 0.0,
) -> PythonComponent:
    """Plain Python: one output "u", inputs named as the function's arguments after the time."""
    arguments = function.__code__.co_varnames[1 : function.__code__.co_argcount]
    return PythonComponent(
        name, function, tuple(map(Port, arguments)), (Port("u", start=start),), period_ns, phase_ns
    )


def system(*parts: Any, stop_ns: int = 100 * MS, **more: Any) -> System:
    """Components and wires in any order; rows every 10 ms unless said otherwise."""
    wires = tuple(p for p in parts if isinstance(p, Connection))
    components = tuple(p for p in parts if not isinstance(p, Connection))
    return System(
        components, wires, **{"start_ns": 0, "record_ns": 10 * MS, "stop_ns": stop_ns, **more}
    )
