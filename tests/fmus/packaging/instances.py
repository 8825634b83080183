"""One face for FMI 2 and FMI 3 co-simulation instances, driven through FMPy's low level."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Slave


@dataclass
class Message:
    status: int
    category: str
    text: str


@dataclass
class Instance:
    """A loaded FMU in co-simulation; `messages` is everything that its logger received."""

    fmu: Any
    version: int
    references: dict[str, int]
    messages: list[Message] = field(default_factory=list)
    callbacks: Any = None

    def instantiate(self, *, logging: bool = False) -> None:
        if self.version == 3:
            self.fmu.instantiate(loggingOn=logging, logMessage=self._log_3)
            return
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._log_2)
        self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE()
        self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE()
        self.fmu.instantiate(loggingOn=logging, callbacks=self.callbacks)

    def initialize(self, tolerance: float | None = None, stop_time: float | None = None) -> None:
        self.enter_initialization(tolerance, stop_time)
        self.fmu.exitInitializationMode()

    def enter_initialization(
        self, tolerance: float | None = None, stop_time: float | None = None
    ) -> None:
        if self.version == 3:
            self.fmu.enterInitializationMode(tolerance=tolerance, stopTime=stop_time)
        else:
            self.fmu.setupExperiment(tolerance=tolerance, stopTime=stop_time)
            self.fmu.enterInitializationMode()

    def get(self, *names: str) -> list[float]:
        return self.get_references([self.references[name] for name in names])

    def get_references(self, references: list[int]) -> list[float]:
        get = self.fmu.getFloat64 if self.version == 3 else self.fmu.getReal
        return list(get(references))

    def set(self, **values: float) -> None:
        set_ = self.fmu.setFloat64 if self.version == 3 else self.fmu.setReal
        set_([self.references[name] for name in values], list(values.values()))

    def step(self, k: int, h: float) -> None:
        self.fmu.doStep(currentCommunicationPoint=k * h, communicationStepSize=h)

    def run(self, names: list[str], n: int, h: float, first: int = 0) -> np.ndarray:
        """Values after each of n steps from step number `first`, shape (n, len(names))."""
        rows = []
        for k in range(first, first + n):
            self.step(k, h)
            rows.append(self.get(*names))
        return np.array(rows)

    def sensitivity(self, unknowns: list[str], knowns: list[str]) -> np.ndarray:
        """d unknowns / d knowns, column by column from directional derivatives."""
        rows = [self.references[name] for name in unknowns]
        columns = [
            self.fmu.getDirectionalDerivative(rows, [self.references[name]], [1.0])
            for name in knowns
        ]
        return np.array(columns).T

    def texts(self, category: str) -> list[str]:
        return [m.text for m in self.messages if m.category == category]

    def _log_3(self, _environment: Any, status: int, category: bytes, text: bytes) -> None:
        self.messages.append(Message(status, category.decode(), text.decode()))

    def _log_2(self, _env: Any, _name: bytes, status: int, category: bytes, text: bytes) -> None:
        self.messages.append(Message(status, category.decode(), text.decode()))


def load(path: Path, folder: Path) -> Instance:
    """Unpack into `folder` and load; not yet instantiated."""
    description = read_model_description(str(path))
    extract(str(path), unzipdir=str(folder))
    version = int(description.fmiVersion[0])
    fmu_class = FMU3Slave if version == 3 else FMU2Slave
    fmu = fmu_class(
        guid=description.guid if version == 2 else description.instantiationToken,
        unzipDirectory=str(folder),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="instance",
    )
    return Instance(fmu, version, {v.name: v.valueReference for v in description.modelVariables})
