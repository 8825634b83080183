"""A plant's equations stepped in this process, without any FMU: what its FMUs are held against.

The equations come as the Python of the portable FMU, the solver is that FMU's, too, and neither
passes through a C compiler, an archive or an importer.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

from fmus.declaration import PlantModel
from fmus.packaging.plant import portable_parts
from fmus.packaging.plant.expressions import plant_expressions
from fmus.packaging.plant.portable import equations_source
from fmus.packaging.plant.portable_parts.instance import Instance


class PlantReference:
    """A plant from its start values; `step` holds inputs for one communication step."""

    def __init__(self, plant: PlantModel) -> None:
        """Generates the equations; raises PackagingError when the plant is not sound."""
        module = ModuleType(f"{portable_parts.__name__}.equations_of_{plant.name}")
        module.__package__ = portable_parts.__name__
        expressions = plant_expressions(plant)
        exec(equations_source(expressions), vars(module))
        self._instance = Instance(module.MODEL)
        names = list(expressions.interface.names)
        self.inputs = tuple(variable.name for variable in plant.inputs)
        self.outputs = tuple(variable.name for variable in plant.outputs)
        self._input_references = [names.index(name) for name in self.inputs]
        self._output_references = [names.index(name) for name in self.outputs]
        self._time = 0.0
        self._instance.setup_experiment(0.0, None, None)

    def step(self, inputs: Sequence[float], length: float) -> list[float]:
        """Hold `inputs`, step by `length` (s), return the outputs."""
        self._instance.set_real(self._input_references, list(inputs))
        self._instance.do_step(self._time, length)
        self._time += length
        return self._instance.get_real(self._output_references)
