"""What every coupling algorithm is: how FMUs step from one instant to the next, as actions.

An algorithm is a class derived from `Algorithm`, in a module of its own, here or in any package
that registers it as an entry point of the group `fmu_harness.algorithms`; `System.algorithm` is
the name of the entry point, or "package.module:Class". When it is asked to `advance`, all outputs
have been read, controllers have computed, and the inputs of the FMUs that are due have the values
of this instant in their slots, not yet in the FMUs. It yields (see `plan.actions`)

    Write       an FMU takes its inputs from their slots; `write` makes them
    Step        an FMU steps from this instant, once; a step that is to be undone is not `final`
    Read        outputs at the end of the step, as the view "reached", after the step
    Transfer, Blend, Slope
                what goes into the slots of inputs: the values of a view, or a mixture of views
    Save, Restore, Iterate, UnlessStop
                a step from a snapshot that is repeated until it agrees with what it was taken for

and whatever it yields, each FMU that is due must have stepped at the end, as far as it is due.
`jacobi` is the shortest example.

An input is constant during a step. On a wire with hold it has the value of one end of the step;
on a linear one that of its middle: between the two ends where the second one is known, and
otherwise along the line through the last two values,

    (y_k + y_k+1) / 2,        y_k + (y_k - y_k-1) / 2.

An FMI 2 FMU that can interpolate its inputs (canInterpolateInputs) gets the value of the beginning
and the slope to the end instead. Either way the mean differs from that of the true signal by O(h²),
so the error of a run is O(h²), against O(h) with hold. In the first step there is no earlier value,
and the line is horizontal. Where an output that depends directly on such an input is read at the
end of the step, the input gets the value of the end before.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from typing import ClassVar, final

from harness import registry
from harness.clock import show
from harness.errors import GraphError, UsageError
from harness.fmi.description.model_description import ModelDescription
from harness.master.plan.actions import Action, Blend, Keep, Restore, Slope, Step, Write, flat
from harness.master.plan.order import by_component, feeding_inputs
from harness.participants.memory import View
from harness.system.graph import Endpoint
from harness.system.lowering import LoweredSystem, Wire
from harness.system.policy import capabilities_of

Groups = tuple[tuple[str, ...], ...]
"""Names of FMUs, group by group."""
Terms = tuple[tuple[View, float], ...]

AHEAD: Terms = (("present", 0.5), ("previous", -0.5))
"""From the value at the beginning of a step to that in its middle, and from there to its end."""
_CHANGE_AHEAD: Terms = (("present", 1.0), ("previous", -1.0))


class Algorithm(ABC):
    """The actions by which the FMUs of a system step; see the module for what one may yield.

    Of a subclass, `advance` is asked for; `solves_loops`, `together`, `refusal` and `knows_end`
    are as here unless it says otherwise; all else is for its use.
    """

    solves_loops: ClassVar[bool] = False
    """Whether algebraic loops are solved where the system says nothing about them."""

    @classmethod
    def together(cls, lowered: LoweredSystem) -> Groups:
        """FMUs that must have equal steps and the same communication points; none."""
        return ()

    @abstractmethod
    def advance(self, due: Mapping[str, int]) -> Iterator[Action]:
        """What lets the FMUs step that are `due`, by so many ns."""

    def refusal(self) -> str:
        """Why the FMUs of the system cannot be stepped so, as a sentence; empty where they can."""
        return ""

    def knows_end(self, wire: Wire) -> bool:
        """Whether the value that a wire brings at the end of the step is known to the FMU at its
        target before the step is over; it is not."""
        return False

    @final
    def __init__(
        self,
        lowered: LoweredSystem,
        descriptions: Mapping[str, ModelDescription],
        written: Mapping[str, tuple[str, ...]],
    ) -> None:
        """`written` are the inputs of each FMU that are written. Raises `GraphError`."""
        self.lowered, self.descriptions, self.written = lowered, descriptions, written
        self.step_ns = {c.name: c.step_ns for c in lowered.fmus}
        self.wires_to = {
            name: [w for w in lowered.wires_to[name] if w.source.component in self.step_ns]
            for name in self.step_ns
        }
        self.capabilities = {
            c.name: capabilities_of(c.policy, descriptions[c.name]) for c in lowered.fmus
        }
        self.interpolating = {
            name for name, c in self.capabilities.items()
            if c.can_interpolate_inputs and descriptions[name].fmi_major == 2
        }  # fmt: skip
        if reason := self.refusal():
            raise GraphError(reason)
        wires = [wire for into in self.wires_to.values() for wire in into]
        self.reached = by_component(w.source for w in wires if self.knows_end(w))
        extrapolated = (w.source for w in wires if w.linear and not self.knows_end(w))
        self.extrapolated = by_component(extrapolated)

    @final
    def begin(self) -> Iterator[Action]:
        """What initialises a run, after all values have been propagated."""
        yield from (Keep(name, outputs) for name, outputs in self.extrapolated.items())

    @final
    def steps(self, due: Mapping[str, int]) -> Iterator[Action]:
        """The FMUs that are due step, by so many ns; their inputs have their present values.

        Raises `GraphError` where the algorithm lets them step otherwise.
        """
        actions = tuple(self.advance(due))
        stepped: dict[str, int] = {}
        for action in flat(actions):
            if isinstance(action, Restore):
                stepped.pop(action.component, None)
            elif isinstance(action, Step):
                stepped[action.component] = stepped.get(action.component, 0) + action.step_ns
        for name in {**due, **stepped}:
            if stepped.get(name, 0) != due.get(name, 0):
                raise GraphError(
                    f"algorithm {self.lowered.system.algorithm!r} lets {name} step by "
                    f"{show(stepped.get(name, 0))} where {show(due.get(name, 0))} are due"
                )
        yield from actions
        for name in due:
            if name in self.extrapolated:
                yield Keep(name, self.extrapolated[name])

    # for the use of algorithms

    @final
    def write(self, names: Iterable[str]) -> Iterator[Write]:
        """FMUs take their inputs."""
        return (Write(name, self.written[name]) for name in names if name in self.written)

    @final
    def ahead(self, name: str) -> list[Wire]:
        """Linear wires to an FMU from those whose end of the step is not known."""
        return [w for w in self.wires_to[name] if w.linear and not self.knows_end(w)]

    @final
    def look_ahead(self, names: Iterable[str]) -> Iterator[Action]:
        """Extrapolate what linear wires bring from FMUs whose end of the step is not known."""
        middle, sloped = self.parted(wire for name in names for wire in self.ahead(name))
        if middle:
            yield Blend(middle, 1.0, AHEAD)
        yield from self.slopes(sloped, 0.0, _CHANGE_AHEAD)

    @final
    def parted(self, wires: Iterable[Wire]) -> tuple[tuple[Wire, ...], tuple[Wire, ...]]:
        """Linear wires that bring the value of the middle, and those that bring a slope."""
        wires = tuple(wires)
        sloped = tuple(w for w in wires if w.target.component in self.interpolating)
        return tuple(w for w in wires if w not in sloped), sloped

    @final
    def slopes(self, wires: tuple[Wire, ...], own: float, terms: Terms) -> Iterator[Slope]:
        """The slopes that wires bring (see `Slope`)."""
        for name in by_component(wire.target for wire in wires):
            into = tuple(wire for wire in wires if wire.target.component == name)
            yield Slope(into, own, terms, name, self.step_ns[name])

    @final
    def feeding(self, wires: Iterable[Wire]) -> tuple[Wire, ...]:
        """Those on which outputs that are read at the end of the step depend directly."""
        found = []
        for wire in wires:
            name = wire.target.component
            outputs = [Endpoint(name, output) for output in self.reached.get(name, ())]
            if any(wire.target in feeding_inputs(end, self.descriptions) for end in outputs):
                found.append(wire)
        return tuple(found)


def algorithm(name: str) -> type[Algorithm]:
    """The algorithm of that name; raises `UsageError`."""
    kind = registry.algorithm(name)
    if not (isinstance(kind, type) and issubclass(kind, Algorithm)):
        raise UsageError(f"algorithm {name!r} is {kind!r}, no subclass of {__name__}.Algorithm")
    return kind
