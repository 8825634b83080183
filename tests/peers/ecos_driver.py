"""An order carried out by ecospy."""

from __future__ import annotations

from ecospy import EcosSimulation, EcosSimulationStructure

from tests.peers.order import answer, read_order


def identifier(port: str) -> str:
    """A port as Ecos names it."""
    return port.replace(".", "::", 1)


def main() -> None:
    order = read_order()
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
            rows = []
            for given in order.rows():
                for port, value in zip(order.inputs, given, strict=True):
                    simulation.set_real(identifier(port), value)
                simulation.step()
                rows.append([simulation.get_real(identifier(port)) for port in order.outputs])
            simulation.terminate()
    answer(rows)


main()
