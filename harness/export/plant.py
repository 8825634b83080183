"""The FMU of a plant as it is handed to others: with its parity certificate."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harness import registry
from harness.export.certificate import FORMAT, with_certificate
from harness.export.certify import plant_certificate


def certified_plant_fmu(
    name: str, fmi_version: int = 3, *, portable: bool = False, targets: Sequence[str] = ()
) -> Path:
    """The path of a plant's FMU with its certificate, made when it is not there yet.

    A plant of another package that has no `reference()` comes without a certificate. Raises
    `FmuError` when there is no FMU, or it does not agree with the plant's equations.
    """
    plain = registry.plant_fmu(name, fmi_version, portable=portable, targets=targets)
    plant: Any = registry.plant(name)
    if not hasattr(plant, "reference"):
        return plain
    path = plain.parent / f"certified-{FORMAT}" / plain.name
    if not path.exists():
        scales = {u.name: (u.start, u.nominal) for u in plant.inputs}
        made = plant_certificate(plain, plant.reference(), scales, plant.step_size)
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".part-", dir=path.parent) as folder:
            part = Path(folder) / path.name
            with_certificate(plain, part, made)
            part.replace(path)
    return path
