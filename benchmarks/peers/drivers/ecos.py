"""Ecos by ecospy: two FMUs, wired by name."""

from ecospy import EcosSimulation, EcosSimulationStructure

from benchmarks.peers.task import Run, Task, carry_out


def prepare(task: Task, steps: int) -> Run:
    structure = EcosSimulationStructure()
    structure.add_model("controller", task.controller)
    structure.add_model("plant", task.plant)
    structure.make_real_connection("plant::y", "controller::y")
    structure.make_real_connection("controller::u", "plant::u")
    simulation = EcosSimulation(structure=structure, step_size=task.step)
    simulation.init()

    def run() -> float:
        simulation.step(steps)
        return float(simulation.get_real("plant::y"))

    return run


carry_out(prepare)
