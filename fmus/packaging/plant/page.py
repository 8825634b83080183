"""The page of documentation inside a plant's FMU."""

from __future__ import annotations

import inspect
import sys

from fmus.declaration import PlantModel
from fmus.packaging.documentation import Page


def plant_page(plant: PlantModel) -> Page:
    """What the plant is, its equations as their module writes them, and tables of variables."""
    module = sys.modules.get(getattr(plant.equations, "__module__", ""))
    return Page(
        f"{plant.name} {plant.version}",
        (plant.description,),
        inspect.getdoc(module) or "",
        (
            ("Inputs", ("name", "unit", "start", "description"),
             tuple((v.name, v.unit, f"{v.start:g}", v.description) for v in plant.inputs)),
            ("Outputs", ("name", "unit", "description"),
             tuple((v.name, v.unit, v.description) for v in plant.outputs)),
            ("States", ("name", "unit", "start", "description"),
             tuple((s.name, s.unit, f"{s.start:g}", s.description) for s in plant.states)),
            ("Parameters", ("name", "unit", "value", "description", "source"),
             tuple((p.name, p.unit, f"{p.value:g}", p.description, p.source)
                   for p in plant.parameters)),
        ),
    )  # fmt: skip
