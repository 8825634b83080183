"""An order carried out by libcosimpy."""

from __future__ import annotations

import os
import sys

from libcosimpy._internal import get_last_error_message
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from tests.peers.order import Order, answer, read_order

Places = dict[str, tuple[int, int]]


def variables(execution: CosimExecution, name: str, index: int) -> Places:
    found = execution.slave_variables(index)
    return {f"{name}.{one.name.decode()}": (index, one.reference) for one in found}


def from_fmus(order: Order) -> tuple[CosimExecution, Places]:
    execution = CosimExecution.from_step_size(step_size=round(order.step * 1e9))
    places: Places = {}
    for name, path in order.fmus.items():
        slave = CosimLocalSlave(fmu_path=path, instance_name=name)
        if not slave.ptr():  # its destructor would end this process without a word
            print(get_last_error_message(), file=sys.stderr, flush=True)
            os._exit(1)
        index = execution.add_local_slave(slave)
        assert index >= 0, get_last_error_message()
        places |= variables(execution, name, index)
    for source, target in order.wires:
        execution.connect_real_variables(*places[source], *places[target])
    for port, value in order.start_values.items():
        assert execution.real_initial_value(*places[port], value)
    return execution, places


def from_package(order: Order) -> tuple[CosimExecution, Places]:
    """The step is the one that the package states."""
    execution = CosimExecution.from_ssp_file(order.package)
    places: Places = {}
    for slave in execution.slave_infos():
        places |= variables(execution, slave.name.decode(), slave.index)
    return execution, places


def main() -> None:
    order = read_order()
    execution, places = (from_package if order.package else from_fmus)(order)
    override, observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
    assert execution.add_manipulator(override)
    assert execution.add_observer(observer)
    rows = []
    for k, given in enumerate(order.rows()):
        for port, value in zip(order.inputs, given, strict=True):
            index, reference = places[port]
            assert override.slave_real_values(index, [reference], [value])
        assert execution.step(), "the step failed"
        assert execution.status().current_time == round((k + 1) * order.step * 1e9)
        found = [places[port] for port in order.outputs]
        rows.append([observer.last_real_values(index, [vr])[0] for index, vr in found])
    answer(rows)


main()
