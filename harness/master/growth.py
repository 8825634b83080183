"""Whether what FMUs that drive each other exchange grows for the whole of a run, as it does where
an algorithm adds energy to a strong coupling.

The run is cut into windows; the largest difference from row to row of a signal must be larger by
half in each than in the one before, which no polynomial of up to the fourth degree is. A system
that is unstable by itself looks the same, and the note says so.
"""

from __future__ import annotations

from typing import Any

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from harness.fmi.description.model_description import REAL_TYPES
from harness.master.plan.planner import Plan
from harness.system.graph import Descriptions
from harness.system.policy import capabilities_of

_BINS, _WINDOWS, _GROWTH = 512, 8, 1.5


class CouplingGrowth:
    """Sees the rows of a run; `note` says in the end what has grown."""

    def __init__(self, plan: Plan, descriptions: Descriptions) -> None:
        self._plan, self._descriptions = plan, descriptions
        system, wires = plan.lowered.system, plan.lowered.fmu_wires
        ends = [(w.source.component, w.target.component) for w in wires]
        graph: Any = nx.DiGraph(ends)
        self._loops = [g for g in nx.strongly_connected_components(graph) if len(g) > 1]
        inside = {w.source for w, (a, b) in zip(wires, ends, strict=True) if self._loop(a, b)}
        self._columns = [
            i
            for i, end in enumerate(plan.recorded)
            if end in inside and descriptions[end.component].port(end.variable).type in REAL_TYPES
        ]
        self._start, stop = system.seconds(system.start_ns), system.seconds(system.stop_ns)
        self._scale = _BINS / max(stop - self._start, 1e-300)
        self._most = np.full((_BINS, len(self._columns)), -1.0)
        self._last: NDArray[np.float64] | None = None

    def _loop(self, *components: str) -> set[str]:
        """The components that drive each other and are these."""
        return next((loop for loop in self._loops if loop.issuperset(components)), set())

    def see(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        """Rows that are recorded, at `times` (s)."""
        if not self._columns:
            return
        values = rows[:, self._columns]
        before = values[:1] if self._last is None else self._last
        with np.errstate(all="ignore"):  # of what is not finite
            differences = np.abs(np.diff(values, axis=0, prepend=before))
        self._last = values[-1:].copy()
        places = np.clip((times - self._start) * self._scale, 0, _BINS - 1).astype(np.int64)
        firsts = np.flatnonzero(np.diff(places, prepend=-1))
        found = np.maximum.reduceat(differences, firsts)
        self._most[places[firsts]] = np.maximum(self._most[places[firsts]], found)

    def note(self) -> str:
        """What has grown and the way out, "" where nothing has."""
        seen = self._most[self._most.max(axis=1, initial=-1.0) >= 0.0]
        if len(seen) < 4 * _WINDOWS:
            return ""
        windows = np.array([part.max(axis=0) for part in np.array_split(seen, _WINDOWS)])
        grows = ((windows[:-1] > 0.0) & (windows[1:] > _GROWTH * windows[:-1])).all(axis=0)
        if not grows.any():
            return ""
        column = int(np.argmax(grows))
        end = self._plan.recorded[self._columns[column]]
        system, loop = self._plan.lowered.system, self._loop(end.component)
        back = all(
            capabilities_of(c.policy, self._descriptions[c.name]).can_get_and_set_fmu_state
            for c in system.fmus
            if c.name in loop
        )
        linear = all(
            w.linear
            for w in self._plan.lowered.fmu_wires
            if loop >= {w.source.component, w.target.component}
        )
        way_out = "smaller communication steps"
        if back and not (linear and system.algorithm == "iterative"):
            way_out = 'algorithm = "iterative" with extrapolation = 1 on the wires between them'
        return (
            f"what {' and '.join(sorted(loop))} exchange grew in every {_WINDOWS}th of the run "
            f"({end}: by {windows[-1, column] / windows[0, column]:.3g}); unless the system is "
            f"unstable by itself, the coupling is too strong for the {system.algorithm} algorithm: "
            f"try {way_out}"
        )
