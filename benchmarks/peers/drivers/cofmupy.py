"""CoFMUPy: two FMUs, its Jacobi method without repetition."""

from cofmupy import Coordinator

from benchmarks.peers.task import Run, Task, carry_out


def wire(source: str, output: str, target: str, input_: str) -> dict[str, object]:
    ends = ({"id": source, "variable": output}, {"id": target, "variable": input_})
    source_end, target_end = ({"type": "fmu", "unit": "", **end} for end in ends)
    return {"source": source_end, "target": [target_end]}


def prepare(task: Task, steps: int) -> Run:
    coordinator = Coordinator()
    coordinator.start({
        "fmus": [
            {"id": "controller", "name": "controller", "path": task.controller},
            {"id": "plant", "name": "plant", "path": task.plant},
        ],
        "connections": [
            wire("plant", "y", "controller", "y"), wire("controller", "u", "plant", "u"),
        ],
        "cosim_method": "jacobi",
        "iterative": False,
    })  # fmt: skip

    def run() -> float:
        for _ in range(steps):
            coordinator.do_step(task.step)
        return float(coordinator.get_variable(("plant", "y"))[-1])

    return run


carry_out(prepare)
