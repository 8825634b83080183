"""An order carried out by ecospy."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from ecospy import EcosSimulation, EcosSimulationStructure

from harness.ssp.package import open_package
from tests.peers.order import Order, answer, read_order


def identifier(port: str) -> str:
    """A port as Ecos names it."""
    return port.replace(".", "::", 1)


@contextmanager
def initialised(order: Order) -> Iterator[EcosSimulation]:
    """The simulation. Ecos applies a set of start values only if it is named."""
    if order.package:
        with open_package(order.package) as package:
            system = next(iter(package.structures.values())).system
        bindings = [one for element in system.elements for one in element.bindings]
        names = [one.inline.name for one in bindings if one.inline]
        with EcosSimulation(ssp_path=order.package, step_size=order.step) as simulation:
            simulation.init(parameter_set=names[0] if names else None)
            yield simulation
        return
    with EcosSimulationStructure() as structure:
        for name, path in order.fmus.items():
            structure.add_model(name, path)
        for source, target in order.wires:
            structure.make_real_connection(identifier(source), identifier(target))
        if order.start_values:
            values = {identifier(port): value for port, value in order.start_values.items()}
            structure.add_parameter_set("start", values)
        with EcosSimulation(structure=structure, step_size=order.step) as simulation:
            simulation.init(parameter_set="start" if order.start_values else None)
            yield simulation


def main() -> None:
    order = read_order()
    rows = []
    with initialised(order) as simulation:
        for given in order.rows():
            for port, value in zip(order.inputs, given, strict=True):
                simulation.set_real(identifier(port), value)
            simulation.step()
            rows.append([simulation.get_real(identifier(port)) for port in order.outputs])
        simulation.terminate()
    answer(rows)
    os._exit(0)  # else TBB's thread may unload what this one ends in, one time in seven


main()
