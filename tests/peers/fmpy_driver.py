"""An order carried out by a master of a few lines on FMPy's own classes (FMI 2).

It steps one FMU after the other, in their order, each with what those before it have just written:
the controller first, then the plant.
"""

from __future__ import annotations

import shutil
from typing import Any

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from tests.peers.order import answer, read_order


def opened(name: str, path: str, folders: list[str]) -> tuple[FMU2Slave, dict[str, int]]:
    description = read_model_description(path)
    folders.append(extract(path))
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folders[-1],
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=name,
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    return slave, {v.name: v.valueReference for v in description.modelVariables}


def main() -> None:
    order = read_order()
    folders: list[str] = []
    fmus = {name: opened(name, path, folders) for name, path in order.fmus.items()}

    def get(port: str) -> float:
        name, _, variable = port.partition(".")
        slave, references = fmus[name]
        return float(slave.getReal([references[variable]])[0])

    def put(port: str, value: Any) -> None:
        name, _, variable = port.partition(".")
        slave, references = fmus[name]
        slave.setReal([references[variable]], [value])

    for port, value in order.start_values.items():
        put(port, value)
    for slave, _ in fmus.values():
        slave.enterInitializationMode()
        slave.exitInitializationMode()
    rows = []
    for k, given in enumerate(order.rows()):
        for port, value in zip(order.inputs, given, strict=True):
            put(port, value)
        for name, (slave, _) in fmus.items():
            for source, target in order.wires:
                if target.startswith(f"{name}."):
                    put(target, get(source))
            slave.doStep(k * order.step, order.step)
        rows.append([get(port) for port in order.outputs])
    for slave, _ in fmus.values():
        slave.terminate()
        slave.freeInstance()
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)
    answer(rows)


main()
