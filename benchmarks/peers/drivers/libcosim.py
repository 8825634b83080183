"""libcosim by libcosimpy: two FMUs and its fixed-step algorithm."""

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from benchmarks.peers.task import Run, Task, carry_out


def prepare(task: Task, steps: int) -> Run:
    execution = CosimExecution.from_step_size(step_size=round(task.step * 1e9))
    places: dict[str, tuple[int, int]] = {}
    for name, path in (("controller", task.controller), ("plant", task.plant)):
        index = execution.add_local_slave(CosimLocalSlave(fmu_path=path, instance_name=name))
        for one in execution.slave_variables(index):
            places[f"{name}.{one.name.decode()}"] = (index, one.reference)
    execution.connect_real_variables(*places["plant.y"], *places["controller.y"])
    execution.connect_real_variables(*places["controller.u"], *places["plant.u"])
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    index, reference = places["plant.y"]

    def run() -> float:
        assert execution.step(steps), "the steps failed"
        return float(observer.last_real_values(index, [reference])[0])

    return run


carry_out(prepare)
