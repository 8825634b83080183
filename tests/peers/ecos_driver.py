"""An order carried out by ecospy."""

from __future__ import annotations

from ecospy import EcosSimulation, EcosSimulationStructure

from tests.peers.order import answer, read_order


def main() -> None:
    order = read_order()
    with EcosSimulationStructure() as structure:
        structure.add_model("fmu", order.fmu)
        if order.start_values:
            values = {f"fmu::{name}": value for name, value in order.start_values.items()}
            structure.add_parameter_set("start", values)
        with EcosSimulation(structure=structure, step_size=order.step) as simulation:
            simulation.init(parameter_set="start" if order.start_values else None)
            rows = []
            for values_now in zip(*order.inputs.values(), strict=True):
                for name, value in zip(order.inputs, values_now, strict=True):
                    simulation.set_real(f"fmu::{name}", value)
                simulation.step()
                rows.append([simulation.get_real(f"fmu::{name}") for name in order.outputs])
            simulation.terminate()
    answer(rows)


main()
