"""An order carried out by libcosimpy."""

from __future__ import annotations

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from tests.peers.order import answer, read_order


def main() -> None:
    order = read_order()
    execution = CosimExecution.from_step_size(step_size=round(order.step * 1e9))
    places = {}
    for name, path in order.fmus.items():
        index = execution.add_local_slave(CosimLocalSlave(fmu_path=path, instance_name=name))
        assert index >= 0, f"{path} was not accepted"
        for variable in execution.slave_variables(index):
            places[f"{name}.{variable.name.decode()}"] = (index, variable.reference)
    for source, target in order.wires:
        execution.connect_real_variables(*places[source], *places[target])
    for port, value in order.start_values.items():
        assert execution.real_initial_value(*places[port], value)
    override, observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
    assert execution.add_manipulator(override)
    assert execution.add_observer(observer)
    rows = []
    for given in order.rows():
        for port, value in zip(order.inputs, given, strict=True):
            index, reference = places[port]
            assert override.slave_real_values(index, [reference], [value])
        assert execution.step(), "the step failed"
        found = [places[port] for port in order.outputs]
        rows.append([observer.last_real_values(index, [vr])[0] for index, vr in found])
    answer(rows)


main()
