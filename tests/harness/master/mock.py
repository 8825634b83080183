"""Mock FMUs: plain Python models behind C functions, driven by the loop like any other FMU.

A model holds one real state s, inputs u_j and outputs y_i:

    y_i = c_i s + sum of (1 + j) / 8 u_j over the inputs on which y_i depends directly
    step of h at t:  s <- 0.9 s + h sum of (1 + j) (u_j + h / 2 * slope of u_j) + t / 64

Integers are rounded, booleans are y_i > 0. The reference simulation calls the models directly.
"""

import ctypes
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

from harness.fmi.binding.logger import LogMessage, MessageLog
from harness.fmi.description.model_description import (
    INTEGER_TYPES,
    REAL_TYPES,
    Capabilities,
    ModelDescription,
    Variable,
)
from harness.system.units import Unit

C_TYPES = {
    "Real": ctypes.c_double, "Integer": ctypes.c_int32, "Float64": ctypes.c_double,
    "Float32": ctypes.c_float, "Int8": ctypes.c_int8, "UInt8": ctypes.c_uint8,
    "Int16": ctypes.c_int16, "UInt16": ctypes.c_uint16, "Int32": ctypes.c_int32,
    "UInt32": ctypes.c_uint32, "Int64": ctypes.c_int64, "UInt64": ctypes.c_uint64,
}  # fmt: skip
FMI2_TYPES = ("Real", "Integer", "Boolean")
FMI3_TYPES = (*(name for name in C_TYPES if name not in FMI2_TYPES), "Boolean")


def as_stored(type_name: str, value: float) -> float:
    """What is left of `value` in a variable of that type."""
    if type_name == "Boolean":
        return float(value != 0.0)
    if type_name in INTEGER_TYPES:
        whole = round(value)
        if C_TYPES[type_name](whole).value != whole:
            raise OverflowError(f"{type_name} {whole}")
        return float(whole)
    return ctypes.c_float(value).value if type_name == "Float32" else value


@dataclass(frozen=True)
class Input:
    name: str
    type: str = "Real"
    unit: str | None = None
    size: int = 0


@dataclass(frozen=True)
class Output:
    name: str
    type: str = "Real"
    gain: float = 1.0
    depends: tuple[str, ...] = ()
    unit: str | None = None
    size: int = 0
    of: str | None = None

    def also(self, name: str) -> "Output":
        """Another name for the same value reference."""
        return replace(self, name=name, of=self.name)


def scalars(port: Input | Output, inputs: tuple[Input, ...] = ()) -> list[Any]:
    """A port, or the elements of an array, whose gains are multiples of the first one's."""
    if isinstance(port, Output):
        arrays = {one.name: [part.name for part in scalars(one)] for one in inputs}
        depends = tuple(name for array in port.depends for name in arrays[array])
        port = replace(port, depends=depends)
    if not port.size:
        return [port]
    more = [{"gain": port.gain * i} if isinstance(port, Output) else {} for i in places(port)]
    names = [f"{port.name}[{i}]" for i in places(port)]
    return [replace(port, name=n, size=0, **m) for n, m in zip(names, more, strict=True)]


def places(port: Input | Output) -> range:
    return range(1, 1 + port.size)


@dataclass
class Model:
    """The behaviour; `values` are those of the inputs, `steps` all (time, step) so far."""

    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    state: float = 1.0
    values: dict[str, float] = field(default_factory=dict)
    steps: list[tuple[float, float]] = field(default_factory=list)
    slopes: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.values = {port.name: 0.0 for port in self.inputs}
        self._input = {port.name: (j, port.type) for j, port in enumerate(self.inputs)}
        self._output = {port.name: port for port in self.outputs}

    def set(self, name: str, value: float) -> None:
        self.values[name] = as_stored(self._input[name][1], value)

    def get(self, name: str) -> float:
        port = self._output[name]
        value = port.gain * self.state
        for source in port.depends:
            value += (1 + self._input[source][0]) / 8 * self.values[source]
        if port.type in INTEGER_TYPES:
            return float(round(value) % 100)
        return float(value > 0.0) if port.type == "Boolean" else as_stored(port.type, value)

    def step(self, time: float, step: float) -> None:
        total = 0.0
        for j, port in enumerate(self.inputs):
            value = self.values[port.name]
            if port.name in self.slopes:
                value += step / 2 * self.slopes[port.name]
            total += (1 + j) * value
        self.state = 0.9 * self.state + step * total + time / 64
        self.steps.append((time, step))


def variable(name: str, reference: int, kind: str, causality: str, **more: Any) -> Variable:
    fixed = {"initial": None, "start": "0", "unit": None, "description": "", "minimum": None,
             "maximum": None, "nominal": None, "size": 1, "dimensions": ()}  # fmt: skip
    return Variable(name, reference, kind, causality, "continuous", **{**fixed, **more})


def describe(
    name: str, fmi_major: int, model: Any, states: bool = False, **capabilities: Any
) -> ModelDescription:
    """The model description of a mock."""
    ports = (*model.inputs, *model.outputs)
    references = {port.name: 10 + i for i, port in enumerate(ports)}
    references |= {port.name: references[port.of] for port in model.outputs if port.of}
    variables = [
        variable(port.name, references[port.name], port.type,
                 "input" if isinstance(port, Input) else "output",
                 unit=port.unit, size=port.size or 1, shape=(port.size,) * bool(port.size))
        for port in ports
    ]  # fmt: skip
    units: dict[str, Unit] = {}
    return ModelDescription(
        name=name, fmi_version=f"{fmi_major}.0", token="", description="", generation_tool="",
        co_simulation=Capabilities(name, states, False, False, False, False, **capabilities),
        model_exchange=None, variables={v.name: v for v in variables}, units=units,
        feedthrough={port.name: port.depends for port in model.outputs}, states=(),
        start_time=None, stop_time=None, step_size=None, tolerance=None,
    )  # fmt: skip


def description_can_repeat(description: ModelDescription) -> bool:
    """Whether steps of the FMU may be undone."""
    capabilities = description.co_simulation
    return capabilities is not None and capabilities.can_get_and_set_fmu_state


class MockInstance:
    """What the run needs of an instance. `calls` are the names of the C functions called;
    `statuses` maps a name to the status that it returns; `hook(name)` is called before each."""

    def __init__(self, fmu: "MockFmu", name: str, echo: Any = None) -> None:
        self.name, self.model, self.description = name, fmu.model(), fmu.description
        self.prefix = f"fmi{self.description.fmi_major}"
        self.handle = 4242
        self.log = MessageLog(echo)
        self.calls: list[str] = []
        self.notes: list[str] = []
        self.statuses, self.hook, self.flags = fmu.statuses, fmu.hook, fmu.flags
        self.dead, self.ended = False, False
        variables = list(self.description.variables.values())
        self._names = {v.value_reference: v.name for v in reversed(variables)}
        self._parts = {r: self.description.scalars(name) for r, name in self._names.items()}
        self._functions: dict[str, Any] = {}
        self.snapshots: dict[int, tuple[float, dict[str, float]]] = {}
        self.repeats = description_can_repeat(self.description)

    def address(self, name: str) -> int:
        if name not in self._functions:
            self._functions[name] = self._make(name)
        return ctypes.cast(self._functions[name], ctypes.c_void_p).value or 0

    def _make(self, name: str) -> Any:
        c, p, n, d = ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_double
        fmi3 = self.prefix == "fmi3"
        if name == "DoStep":
            flags = (p, p, p, p) if fmi3 else ()
            return ctypes.CFUNCTYPE(c, p, d, d, ctypes.c_bool, *flags)(self._do_step)
        if name[1:].lower() == "etfmustate":
            return ctypes.CFUNCTYPE(c, p, p)(self._get_state if name[0] == "G" else self._set_state)
        if name == "SetRealInputDerivatives":
            return ctypes.CFUNCTYPE(c, p, p, n, p, p)(self._set_slopes)
        kind = name[3:]
        ctype = C_TYPES.get(kind, ctypes.c_uint8 if fmi3 else ctypes.c_int32)

        def transfer(handle: int, references: int, count: int, values: int, *size: int) -> int:
            given = (ctypes.c_uint32 * count).from_address(references)
            names = [name for reference in given for name in self._parts[reference]]
            assert handle == 4242 and all(one == len(names) for one in size)
            data = (ctype * len(names)).from_address(values)
            for i, variable_name in enumerate(names):
                assert self.description.port(variable_name).type in (kind, "Enumeration")
                if name.startswith("Set"):
                    self.model.set(variable_name, float(data[i]))
                else:
                    value = self.model.get(variable_name)
                    data[i] = value if kind in REAL_TYPES else int(value)
            return self._status(name)

        return ctypes.CFUNCTYPE(c, p, p, n, p, *((n,) if fmi3 else ()))(transfer)

    def _do_step(self, handle: int, time: float, step: float, keep: bool, *flags: int) -> int:
        assert handle == 4242 and (keep or self.repeats)
        if flags:
            for place, flag in zip(flags[:3], self.flags(time), strict=True):
                ctypes.c_uint8.from_address(place).value = flag
        self.model.step(time, step)
        return self._status("DoStep")

    def _set_slopes(
        self, handle: int, references: int, count: int, orders: int, values: int
    ) -> int:
        assert list((ctypes.c_int32 * count).from_address(orders)) == [1] * count
        data = (ctypes.c_double * count).from_address(values)
        for i, reference in enumerate((ctypes.c_uint32 * count).from_address(references)):
            self.model.slopes[self._names[reference]] = data[i]
        return self._status("SetRealInputDerivatives")

    def _get_state(self, handle: int, place: int) -> int:
        """Always a new pointer, as the standard allows."""
        pointer = ctypes.c_int64.from_address(place)
        self.snapshots.pop(pointer.value, None)
        self.issued = pointer.value = getattr(self, "issued", 16) + 16
        self.snapshots[pointer.value] = (self.model.state, dict(self.model.values))
        return self._status("GetState")

    def _set_state(self, handle: int, pointer: int) -> int:
        self.model.state, values = self.snapshots[pointer]
        self.model.values = dict(values)
        return self._status("SetState")

    def free_state(self, state: ctypes.c_void_p) -> None:
        del self.snapshots[state.value or 0]

    @property
    def alive(self) -> bool:
        return not self.dead

    def _status(self, name: str) -> int:
        assert not self.dead, f"{name} called after Fatal"
        self.calls.append(name)
        self.hook(self, name)
        status = self.statuses.get(name, 0)
        if status:
            self.log.messages.append(LogMessage(status, "test", f"{name} said {status}"))
        return status

    def asks_for_the_end(self) -> bool:
        return self.ended

    def mark_dead(self) -> None:
        self.dead = True

    def set(self, values: Any) -> None:
        for name, value in values.items():
            self.model.set(name, value)

    def tell_experiment(self, *times: float | None) -> None:
        pass

    def enter_initialization_mode(self, start: float, stop: float, tolerance: float | None) -> None:
        self._status(f"Enter({start!r}, {stop!r}, {tolerance!r})")

    def exit_initialization_mode(self) -> None:
        self._status("Exit")

    def terminate(self) -> None:
        self._status("Terminate")

    def free(self) -> None:
        if not self.dead:
            self._status("Free")


class MockFmu:
    """What the run needs of an FMU; `instances` are those made so far."""

    def __init__(
        self,
        inputs: tuple[Input, ...] = (Input("u"),),
        outputs: tuple[Output, ...] = (Output("y"),),
        fmi_major: int = 2,
        state: float = 1.0,
        kind: Callable[..., Model] = Model,
        states: bool = False,
        **capabilities: Any,
    ) -> None:
        elements = tuple(part for port in inputs for part in scalars(port))
        made = tuple(part for port in outputs for part in scalars(port, inputs))
        self.model = lambda: kind(elements, made, state)
        ports = SimpleNamespace(inputs=inputs, outputs=outputs)
        self.description = describe("mock", fmi_major, ports, states, **capabilities)
        self.instances: list[MockInstance] = []
        self.statuses: dict[str, int] = {}
        self.hook: Callable[[MockInstance, str], None] = lambda instance, name: None
        self.flags: Callable[[float], tuple[int, int, int]] = lambda time: (0, 0, 0)

    def instantiate(
        self, name: str, *, logging: bool = False, echo: Any = None, **_: Any
    ) -> MockInstance:
        self.instances.append(MockInstance(self, name, echo))
        return self.instances[-1]
