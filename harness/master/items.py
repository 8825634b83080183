"""Values of enumerations that are no item of them, seen in the rows of a run.

What a user gives is refused before a run. What an FMU computes, or a wire brings, is told: the run
goes on with the number, as FMI has it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.fmi.binding.values import item_names
from harness.master.plan.planner import Plan
from harness.master.recorded import column_type
from harness.system.graph import Descriptions


class UnknownItems:
    """Sees the rows of a run; `notes` has a sentence for each port with a value that is no item."""

    def __init__(self, plan: Plan, descriptions: Descriptions) -> None:
        self.notes: list[str] = []
        self._single = plan.lowered.system.single
        self._left = {
            end: (column, descriptions[end.component])
            for column, end in enumerate(plan.recorded)
            if end.component in descriptions
            and descriptions[end.component].port(end.variable).details.items
        }

    def see(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        """Rows that are recorded, at `times` (s)."""
        for end, (column, d) in list(self._left.items()):
            variable, values = d.port(end.variable), rows[:, column]
            if column_type(d, end.variable) == "int64":
                values = np.ascontiguousarray(values).view(np.int64)
            other = ~np.isin(values, [number for number, _ in variable.details.items])
            if other.any():
                first = int(np.argmax(other))
                name = end.variable if self._single else str(end)
                self.notes.append(
                    f"{name} is {int(values[first])} at t = {times[first]:.9g} s, which is no item "
                    f"of its enumeration: {item_names(variable)}"
                )
                del self._left[end]
