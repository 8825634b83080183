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
    index = execution.add_local_slave(CosimLocalSlave(fmu_path=order.fmu, instance_name="fmu"))
    assert index >= 0, "the FMU was not accepted"
    references = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
    for name, value in order.start_values.items():
        assert execution.real_initial_value(index, references[name], value)
    override, observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
    assert execution.add_manipulator(override)
    assert execution.add_observer(observer)
    inputs = [references[name] for name in order.inputs]
    outputs = [references[name] for name in order.outputs]
    rows = []
    for values in zip(*order.inputs.values(), strict=True):
        assert override.slave_real_values(index, inputs, list(values))
        assert execution.step(), "the step failed"
        rows.append(list(observer.last_real_values(index, outputs)))
    answer(rows)


main()
