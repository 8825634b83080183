"""FMPy: its classes in a loop of a few lines, as its examples write it."""

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from benchmarks.peers.task import Run, Task, carry_out


def prepare(task: Task, steps: int) -> Run:
    description = read_model_description(task.plant)
    references = {one.name: one.valueReference for one in description.modelVariables}
    plant = FMU2Slave(
        guid=description.guid,
        unzipDirectory=extract(task.plant),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="plant",
    )
    plant.instantiate()
    plant.setupExperiment(startTime=0.0)
    plant.enterInitializationMode()
    plant.exitInitializationMode()
    compute = task.python_controller()
    u, y = [references["u"]], [references["y"]]

    def run() -> float:
        rows = []
        for k in range(steps):
            measured = plant.getReal(y)[0]
            control = compute(measured)
            plant.setReal(u, [control])
            rows.append((k * task.step, measured, control))
            plant.doStep(currentCommunicationPoint=k * task.step, communicationStepSize=task.step)
        return float(plant.getReal(y)[0])

    return run


carry_out(prepare)
