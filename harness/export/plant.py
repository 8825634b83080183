"""The FMU of a plant as it is handed to others: with its parity certificate."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness import registry
from harness.errors import UsageError
from harness.export.certificate import FORMAT, with_certificate
from harness.export.certify import plant_certificate
from harness.export.controller import identifier


def certified_plant_fmu(
    name: str,
    fmi_version: int = 3,
    *,
    portable: bool = False,
    targets: Sequence[str] = (),
    rename: str | None = None,
) -> Path:
    """The path of a plant's FMU with its certificate, made when it is not there yet; the model is
    called `rename` if given.

    A plant of another package that has no `reference()` comes without a certificate. Raises
    `FmuError` when there is no FMU, or it does not agree with the plant's equations.
    """
    plant: Any = registry.plant(name)
    if rename is not None:
        try:
            plant = replace(plant, name=identifier(rename))
        except TypeError as fault:
            raise UsageError(f"plant {name} cannot have another name: {fault}") from fault
    plain = registry.plant_fmu(plant, fmi_version, portable=portable, targets=targets)
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
