"""PathSim with PathSim-FMI: the plant's FMU as a block, the controller as a sampled function."""

from pathsim import Connection, Simulation
from pathsim.blocks import Wrapper
from pathsim_fmi import CoSimulationFMU

from benchmarks.peers.task import Run, Task, carry_out


def prepare(task: Task, steps: int) -> Run:
    plant = CoSimulationFMU(task.plant, dt=task.step)
    controller = Wrapper(task.python_controller(), T=task.step)
    wires = [Connection(plant, controller), Connection(controller, plant)]
    simulation = Simulation([controller, plant], wires, dt=task.step, log=False)

    def run() -> float:
        simulation.run((steps - 1) * task.step)
        return float(plant.outputs[0])

    return run


carry_out(prepare)
