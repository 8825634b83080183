"""SOFiRpy: the plant's FMU and a controller as a Python model, rows as a DataFrame."""

import logging
from pathlib import Path

from sofirpy import SimulationEntity
from sofirpy.simulation import simulation

from benchmarks.peers.task import Run, Task, carry_out

simulation.tqdm = lambda steps: steps  # its progress bar is none of the loop's work


def model(task: Task) -> type:
    class Controller(SimulationEntity):
        def initialize(self, start_values: dict[str, object]) -> None:
            self.values = {"y": 0.0, "u": 0.0}
            self.compute = task.python_controller()

        def set_parameter(self, name: str, value: float) -> None:
            self.values[name] = value

        def get_parameter_value(self, name: str) -> float:
            return self.values[name]

        def do_step(self, time: float) -> None:
            self.values["u"] = self.compute(self.values["y"])

    return Controller


def wire(name: str, source: str) -> dict[str, str]:
    return {
        "parameter_name": name,
        "connect_to_system": source,
        "connect_to_external_parameter": name,
    }


def prepare(task: Task, steps: int) -> Run:
    fmus = simulation.init_fmus({"plant": Path(task.plant)}, task.step, {})
    models = simulation.init_models({"controller": model(task)}, {})
    wires = simulation.init_connections(
        {"plant": [wire("u", "controller")], "controller": [wire("y", "plant")]}
    )
    rows = simulation.init_parameter_list({"plant": ["y"], "controller": ["u"]})
    loop = simulation.Simulator({**fmus, **models}, wires, rows)

    def run() -> float:
        found = loop.simulate((steps + 0.5) * task.step, task.step, task.step)
        return float(found["plant.y"].iloc[steps])

    return run


logging.disable()
carry_out(prepare)
