"""A plant that makes its own FMU: what entry points of the group `fmu_harness.plants` name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fmus.declaration import PlantModel

if TYPE_CHECKING:
    from fmus.packaging.plant.reference import PlantReference


@dataclass(frozen=True, eq=False)
class Plant(PlantModel):
    """A declared plant (`PlantModel`) with its FMU and its reference.

    Both need CasADi, which is imported when they are asked for.
    """

    def fmu(
        self, fmi_version: int = 3, *, portable: bool = False, targets: Sequence[str] = ()
    ) -> Path:
        """Path of this plant's FMU in the user cache, built when it is not there yet.

        `fmi_version` is 2 or 3; `portable` asks for the packaging in Python;
        `targets` are the platforms of its binaries, such as "aarch64-linux", or "all".
        Raises `fmus.packaging.errors.PackagingError` when it cannot be built.
        """
        from fmus.packaging.plant.build import cached_fmu

        return cached_fmu(self, fmi_version, portable=portable, targets=targets)

    def reference(self) -> PlantReference:
        """The equations stepped in this process, without any FMU, from the start values.

        Raises `fmus.packaging.errors.PackagingError` when the plant is not sound.
        """
        from fmus.packaging.plant.reference import PlantReference

        return PlantReference(self)
