"""An FMU as the harness holds it: archive, model description, instances."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from harness.display import html_table
from harness.fmi.archive.unpack import Archive
from harness.fmi.binding.interface import CO_SIMULATION, InterfaceType
from harness.fmi.binding.library import unload_below
from harness.fmi.description.faults import notes
from harness.fmi.description.reader import read_model_description

if TYPE_CHECKING:
    from harness.fmi.binding.instance import FmuInstance
    from harness.fmi.binding.logger import LogMessage


class Fmu(Archive):
    """An unpacked FMU: `description` is what it says of itself, `sha256` its hash, `faults` are
    those of the description that were let pass, and `notes` sentences about them.

    Use as a context manager, or call `close`, to remove the unpacked files.
    """

    def __init__(self, path: str | Path, *, validate: bool = True) -> None:
        """Unpack and read; raises `FmuError`. Without `validate`, faults of the description that
        do not keep it from being read are let pass."""
        super().__init__(Path(path))
        try:
            self.description, self.faults = read_model_description(
                self.folder, self.path, validate=validate
            )
        except BaseException:
            self.close()
            raise

    def __repr__(self) -> str:
        d = self.description
        return f"<Fmu: {d.name}, FMI {d.fmi_version}, {len(d.variables)} variables, {self.path}>"

    def _repr_html_(self) -> str:
        """Inputs, outputs and parameters."""
        shown = ("input", "output", "parameter", "structuralParameter")
        variables = [v for v in self.description.variables.values() if v.causality in shown]
        rows = [(v.name, v.causality, v.type, v.start or "", v.unit or "", v.description)
                for v in sorted(variables, key=lambda v: shown.index(v.causality))]  # fmt: skip
        heads = ("variable", "causality", "type", "start", "unit", "description")
        return html_table(repr(self).strip("<>"), heads, rows)

    @property
    def notes(self) -> tuple[str, ...]:
        """What is wrong with the description and was let pass, in a sentence or two."""
        return notes(self.faults, self.path, validate=False)

    def instantiate(
        self,
        name: str,
        *,
        interface_type: InterfaceType = CO_SIMULATION,
        event_mode: bool = False,
        early_return: bool = False,
        logging: bool = False,
        echo: Callable[[LogMessage], None] | None = None,
    ) -> FmuInstance:
        """A new instance; raises `FmuError`. `event_mode` and `early_return` say that the caller
        handles events and steps that end early, in FMI 3 co-simulation."""
        from harness.fmi.binding.fmi1 import Fmi1Instance
        from harness.fmi.binding.fmi2 import Fmi2Instance
        from harness.fmi.binding.fmi3 import Fmi3Instance

        kind: type[FmuInstance] = (Fmi1Instance, Fmi2Instance, Fmi3Instance)[
            self.description.fmi_major - 1
        ]
        return kind(
            self.description, self.folder, name, interface_type=interface_type,
            event_mode=event_mode, early_return=early_return, logging=logging, echo=echo,
        )  # fmt: skip

    def close(self) -> None:
        """Unload the library where no instance is left, and remove the unpacked files."""
        unload_below(self.folder)
        super().close()
