"""An order carried out with FMPy: packages and equations by its own functions, FMUs (FMI 2 and 3)
by a master of a few lines on its own classes.

That master steps one FMU after the other, in their order, each with what those before it have just
written: the controller first, then the plant.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.ssp.simulation import simulate_ssp

from tests.peers.order import TOLERANCE, Order, answer, read_order


@dataclass
class Opened:
    """An instance, with the differences between the versions of FMI out of the way."""

    slave: Any
    references: dict[str, int]
    version: int
    folder: str

    def get(self, variable: str) -> float:
        read = self.slave.getReal if self.version == 2 else self.slave.getFloat64
        return float(read([self.references[variable]])[0])

    def put(self, variable: str, value: float) -> None:
        write = self.slave.setReal if self.version == 2 else self.slave.setFloat64
        write([self.references[variable]], [value])

    def initialise(self) -> None:
        if self.version == 2:
            self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()


def opened(name: str, path: str) -> Opened:
    description = read_model_description(path)
    version, folder = int(description.fmiVersion[0]), extract(path)
    slave = (FMU2Slave if version == 2 else FMU3Slave)(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=name,
    )
    slave.instantiate()
    references = {v.name: v.valueReference for v in description.modelVariables}
    return Opened(slave, references, version, folder)


def rows_of_fmus(order: Order) -> list[list[float]]:
    fmus = {name: opened(name, path) for name, path in order.fmus.items()}

    def get(port: str) -> float:
        name, _, variable = port.partition(".")
        return fmus[name].get(variable)

    def put(port: str, value: float) -> None:
        name, _, variable = port.partition(".")
        fmus[name].put(variable, value)

    for port, value in order.start_values.items():
        put(port, value)
    for one in fmus.values():
        one.initialise()
    rows = []
    for k, given in enumerate(order.rows()):
        for port, value in zip(order.inputs, given, strict=True):
            put(port, value)
        for name, one in fmus.items():
            for source, target in order.wires:
                if target.startswith(f"{name}."):
                    put(target, get(source))
            one.slave.doStep(k * order.step, order.step)
        rows.append([get(port) for port in order.outputs])
    for one in fmus.values():
        one.slave.terminate()
        one.slave.freeInstance()
        shutil.rmtree(one.folder, ignore_errors=True)
    return rows


def rows_of_package(order: Order) -> list[list[float]]:
    stop_time = (order.steps - 0.5) * order.step  # the sum of steps must not pass it too late
    found = simulate_ssp(order.package, stop_time=stop_time, step_size=order.step)
    return [[float(row[port]) for port in order.outputs] for row in found]


def rows_of_equations(order: Order) -> list[list[float]]:
    """Under inputs that FMPy is given two rows of wherever they jump."""
    ((name, path),) = order.fmus.items()
    rows = [(k * order.step, *row) for k, row in enumerate(order.rows())]
    held = [(after[0], *before[1:]) for before, after in pairwise(rows)]
    inputs = [port.removeprefix(f"{name}.") for port in order.inputs]
    outputs = [port.removeprefix(f"{name}.") for port in order.outputs]
    found = simulate_fmu(
        path, fmi_type="ModelExchange", stop_time=order.steps * order.step,
        output_interval=order.step, relative_tolerance=TOLERANCE, record_events=False,
        output=outputs,
        input=np.array(
            sorted([*held, *rows], key=lambda row: row[0]),
            dtype=[("time", float), *((one, float) for one in inputs)],
        ),
    )  # fmt: skip
    return [[float(row[one]) for one in outputs] for row in found[1:]]


def main() -> None:
    order = read_order()
    if order.interface == "model-exchange":
        answer(rows_of_equations(order))
    else:
        answer((rows_of_package if order.package else rows_of_fmus)(order))


main()
