"""A system opened, checked and planned once, and run as often as one likes.

Runs of a study differ in their seed, points of a sweep in start values; neither changes which
FMUs are opened, nor the plan. Every run has instances, block states and noise of its own, so a
run does not depend on those before it: the first and the hundredth give the same bits.

Two kinds of component cannot promise that: plain Python that cannot be copied (see
`participants.fresh`), and an FMU that may be instantiated once in a process only. `repeatable` says
whether there are none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

from harness.errors import UsageError, nearest
from harness.fmi.binding.logger import LogMessage
from harness.fmi.fmu import Fmu
from harness.interrupts import INTERRUPTED, Interrupts, TerminatedError
from harness.master.opened import descriptions_of, only_once, opened
from harness.master.plan.planner import Plan
from harness.master.recorded import columns_of
from harness.master.run import Progress, execute, plan_system
from harness.results.manifest import FmuRecord, Manifest
from harness.results.recording import Recording
from harness.results.result import Result
from harness.system.check import check
from harness.system.graph import Component, Endpoint, FmuComponent, PythonComponent, System

Echo = Callable[[str, LogMessage], None]
StartValues = Mapping[str, Mapping[str, Any]]
"""Start values by FMU component and variable."""


class PreparedSystem:
    """A planned system, its `plan`, with its `fmus` open; a context manager that closes them."""

    def __init__(self, system: System, record: Sequence[str | Endpoint] = ("*",)) -> None:
        """Open, check and plan; raises `HarnessError`."""
        self._stack = ExitStack()
        with ExitStack() as stack:
            self.fmus = stack.enter_context(opened(system))
            self.plan = plan_system(system, self.fmus, tuple(record))
            self._columns = columns_of(self.plan, self.fmus)
            self._stack = stack.pop_all()

    @property
    def repeatable(self) -> bool:
        """Whether no component remembers a run."""
        return not any(map(self._remembers, self.plan.lowered.system.components))

    def manifest(self, needed: Iterable[str], seed: int | None = None) -> Manifest:
        """What a run is made of; raises `UsageError` for a signal that is `needed` and not
        recorded."""
        names = [column.name for column in self._columns]
        for name in needed:
            if name not in names:
                raise UsageError(
                    f"signal {name!r} is asked for but not recorded; {nearest(name, names)}"
                )
        records = tuple(FmuRecord(n, fmu.path.name, fmu.sha256) for n, fmu in self.fmus.items())
        seeds = {"seed": self.plan.lowered.system.seed if seed is None else seed}
        told = dict.fromkeys(note for fmu in self.fmus.values() for note in fmu.notes)
        notes = (*told, *self.plan.notes)
        return Manifest(self._columns, fmus=records, seeds=seeds, notes=notes)

    def run(
        self,
        folder: str | Path | None = None,
        *,
        seed: int | None = None,
        start_values: StartValues | None = None,
        progress: Progress | None = None,
        echo: Echo | None = None,
        experiment: Mapping[str, Any] | None = None,
        needed: Iterable[str] = (),
        overwrite: bool = False,
    ) -> Result:
        """Run with another `seed`, and with `start_values` besides those of the system.

        The rest is as in `Bench.run`.
        """
        plan = self.plan
        if seed is not None or start_values:
            plan = _changed(plan, self.fmus, seed, start_values or {})
        manifest = replace(self.manifest(needed, seed), experiment=dict(experiment or {}))
        place = None if folder is None else Path(folder)
        with (
            Interrupts() as interrupts,
            Recording(self._columns, place, manifest, overwrite=overwrite) as recording,
        ):

            def moved(share: float) -> None:
                if interrupts.reason:
                    raise interrupts.fault()
                if progress is not None:
                    progress(share)

            try:
                outcome = execute(plan, self.fmus, recording, progress=moved, echo=echo)
            except (KeyboardInterrupt, TerminatedError) as interrupt:
                said = str(interrupt) or f"{INTERRUPTED} (KeyboardInterrupt)"
                interrupt.result = recording.finish(said)  # type: ignore[union-attr]
                raise
            recording.add_notes(outcome.notes)
            result = recording.finish("" if outcome.fault is None else str(outcome.fault))
        if outcome.fault is not None:
            outcome.fault.result = result
            raise outcome.fault
        return result

    def close(self) -> None:
        """Close the FMUs."""
        self._stack.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _remembers(self, component: Component) -> bool:
        if isinstance(component, FmuComponent):
            return only_once(component, self.fmus[component.name].description)
        return isinstance(component, PythonComponent) and bool(component.uncopied)


def _changed(
    plan: Plan, fmus: Mapping[str, Fmu], seed: int | None, start_values: StartValues
) -> Plan:
    """`plan` for another seed and other start values, which are checked like those of a system."""
    lowered = plan.lowered
    legal = [component.name for component in lowered.fmus]
    for name in start_values:
        if name not in legal:
            raise UsageError(f"start values of {name!r}, which is no FMU; {nearest(name, legal)}")

    def moved(component: Component) -> Component:
        if isinstance(component, FmuComponent) and component.name in start_values:
            merged = {**component.start_values, **start_values[component.name]}
            return replace(component, start_values=merged)
        return component

    system = replace(
        lowered.system,
        components=tuple(map(moved, lowered.system.components)),
        seed=lowered.system.seed if seed is None else seed,
    )
    if start_values:
        check(system, descriptions := descriptions_of(system, fmus))
        if descriptions != descriptions_of(lowered.system, fmus):
            raise UsageError(
                "start values that change the sizes of arrays cannot differ between runs of one "
                "plan; give them to the system itself"
            )
    components = tuple(map(moved, lowered.components))
    return replace(plan, lowered=replace(lowered, system=system, components=components))
