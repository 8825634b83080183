"""The rates of a system: the cycle that they share, and what falls on which instant of it.

Rates need not divide one another: each component is due at its own instants, phase + k period, and
sees of others what they had at their last one. It refuses phases outside of their period, cycles
of more than `MAX_INSTANTS` instants, and communication points that an FMU cannot keep.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.clock import common_cycle, show
from harness.errors import TimingError
from harness.fmi.description.model_description import ModelDescription
from harness.system.graph import FmuComponent, SampledComponent, SensitivityComponent
from harness.system.lowering import DelayComponent, LoweredSystem
from harness.system.policy import capabilities_of

MAX_INSTANTS = 1_000_000


class Rates:
    """`cycle_ns` after which everything repeats, and `grid`: the communication points of each FMU
    in it (ns after its beginning). `notes` are sentences on rates that do not divide."""

    def __init__(
        self,
        lowered: LoweredSystem,
        descriptions: Mapping[str, ModelDescription],
        together: tuple[tuple[str, ...], ...] = (),
    ) -> None:
        """FMUs that step `together` get the same grid. Raises `TimingError`."""
        self.lowered = lowered
        self.system = lowered.system
        self.descriptions = descriptions
        self.fmus = {c.name: c for c in lowered.fmus}
        self._check_phases()
        self._check_sensitivities()
        self.notes = tuple(dict.fromkeys(self._rate_notes()))
        periods = [c.period_ns for c in lowered.components]
        self.cycle_ns = common_cycle([*periods, self.system.record_ns])
        self._check_size()
        self.grid = {name: self._communication_offsets(c) for name, c in self.fmus.items()}
        self._check_stop()
        for group in together:
            self._join_grids(group)
        self._check_linear_wires()

    def _check_phases(self) -> None:
        for c in self.lowered.sampled:
            if c.phase_ns < 0:
                raise TimingError(f"{c.name}: phase {show(c.phase_ns)} is negative")
            if c.phase_ns >= c.period_ns:
                raise TimingError(
                    f"{c.name}: phase {show(c.phase_ns)} is not below its period "
                    f"{show(c.period_ns)}"
                )

    def _check_sensitivities(self) -> None:
        for c in self.lowered.sampled:
            if isinstance(c, SensitivityComponent):
                step_ns = self.fmus[c.component].step_ns
                if c.period_ns % step_ns or c.phase_ns % step_ns:
                    raise TimingError(
                        f"sensitivity {c.name} runs every {show(c.period_ns)} (first at "
                        f"{show(c.phase_ns)}) but {c.component} steps by {show(step_ns)}: both "
                        "must be whole multiples of it"
                    )

    def _rate_notes(self) -> Iterator[str]:
        for wire in self.lowered.wires:
            names = sorted((wire.source.component, wire.target.component))
            first, second = (self.lowered.by_name[name] for name in names)
            fmu = next((c for c in (first, second) if isinstance(c, FmuComponent)), None)
            other = second if fmu is first else first
            if fmu is None or isinstance(other, DelayComponent):
                continue
            fast, slow = sorted((fmu.step_ns, other.period_ns))
            if slow % fast or (fast == fmu.step_ns and other.phase_ns % fast):
                offset = f" (first at {show(other.phase_ns)})" if other.phase_ns else ""
                yield (
                    f"{other.name} runs every {show(other.period_ns)}{offset} and {fmu.name} steps "
                    f"by {show(fmu.step_ns)}: in between, each sees what the other had at its "
                    "last instant"
                )

    def _join_grids(self, group: tuple[str, ...]) -> None:
        """FMUs that step together communicate at the same instants."""
        steps = {self.fmus[name].step_ns for name in group}
        if len(steps) > 1:
            text = ", ".join(f"{name} {show(self.fmus[name].step_ns)}" for name in group)
            raise TimingError(
                f"the {self.system.algorithm} algorithm lets FMUs that drive each other step "
                f"together, so their steps must be equal: {text}"
            )
        joined = tuple(sorted({offset for name in group for offset in self.grid[name]}))
        for name in group:
            if not self._variable(name) and self.grid[name] != joined:
                raise TimingError(
                    f"a delayed value arrives between the steps of FMUs that step together "
                    f"with {name}, whose FMU takes steps of {show(*steps)} only; use a delay "
                    "that is a multiple of it"
                )
            self.grid[name] = joined

    def _check_linear_wires(self) -> None:
        for wire in self.lowered.fmu_wires:
            source, name = wire.source.component, wire.target.component
            uneven = any(offset % self.fmus[name].step_ns for offset in self.grid[name])
            if wire.linear and (uneven or self.grid[source] != self.grid[name]):
                raise TimingError(
                    f"connection {wire.source} -> {wire.target} is extrapolated, for which "
                    f"{source} and {name} must communicate at the same, evenly spaced "
                    f"instants: {self._spacing(source)}, {self._spacing(name)}"
                )

    def _spacing(self, name: str) -> str:
        grid = self.grid[name]
        more = ", …" if len(grid) > 4 else ""
        return f"{name} at {', '.join(map(show, grid[:4]))}{more}"

    def _variable(self, name: str) -> bool:
        """Whether an FMU takes steps of any size."""
        policy = self.fmus[name].policy
        return capabilities_of(policy, self.descriptions[name]).can_handle_variable_step

    def _communication_offsets(self, fmu: FmuComponent) -> tuple[int, ...]:
        offsets = set(range(0, self.cycle_ns, fmu.step_ns))
        fixed = not self._variable(fmu.name)
        if self.system.single and not fixed:
            offsets |= set(range(0, self.cycle_ns, self.system.record_ns))
        for wire in self.lowered.wires_to[fmu.name]:
            source = self.lowered.by_name[wire.source.component]
            if not isinstance(source, DelayComponent):
                continue
            arrivals = set(self.sample_offsets(source))
            if fixed and arrivals - set(range(0, self.cycle_ns, fmu.step_ns)):
                raise TimingError(
                    f"{wire.source} arrives between the steps of {fmu.name}, whose FMU takes steps "
                    f"of {show(fmu.step_ns)} only; use a delay that is a multiple of it"
                )
            offsets |= arrivals
        return tuple(sorted(offsets))

    def sample_offsets(self, component: SampledComponent) -> range:
        """The sample instants of a component in a cycle, ns after its beginning."""
        return range(component.phase_ns, self.cycle_ns, component.period_ns)

    def _check_size(self) -> None:
        rates = {c.name: c.period_ns for c in self.lowered.components}
        count = sum(self.cycle_ns // period for period in rates.values())
        if count > MAX_INSTANTS:
            text = ", ".join(f"{name} {show(period)}" for name, period in sorted(rates.items())[:8])
            raise TimingError(
                f"the rates share no cycle shorter than {show(self.cycle_ns)}, which would take "
                f"{count} instants (at most {MAX_INSTANTS}); choose rates with a shorter common "
                "multiple: "
                f"{text}"
            )

    def _check_stop(self) -> None:
        if self.system.single:
            return
        length = self.system.stop_ns - self.system.start_ns
        common = common_cycle(fmu.step_ns for fmu in self.fmus.values())
        nearest_ns = self.system.start_ns + max(1, round(length / common)) * common
        for fmu in self.fmus.values():
            if length % fmu.step_ns:
                raise TimingError(
                    f"{fmu.name} steps by {show(fmu.step_ns)}, which does not divide the run of "
                    f"{show(length)}; the nearest stop time is {show(nearest_ns)}"
                )
