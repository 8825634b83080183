"""An experiment without FMUs: a first-order lag under PID, with noise and two variants."""

from dataclasses import dataclass
from pathlib import Path

from harness.cli.options import settings
from harness.experiment.experiment import Experiment


@dataclass
class Lag:
    """y <- y + gain (u - y) each sample, as a plain Python controller."""

    gain: float = 0.2
    y: float = 0.0

    def step(self, time: float, u: float) -> float:
        self.y += self.gain * (u - self.y)
        return self.y


FILE = """
title = "A lag under PID"
stop_time = 1.0
step = 0.01
seed = 5

[components.lag]
controller = "tests.harness.experiment.loops:Lag"
outputs = ["y"]
parameters = { gain = 0.3 }

[components.controller]
controller = "pid"
parameters = { kp = 0.5, ki = 8.0, u_min = -10.0, u_max = 10.0 }

[components.reference]
signal = "step"
parameters = { time = 0.1, final = 2.0 }

[connections]
"controller.reference" = "reference.value"
"lag.u" = { from = "controller.u", delay = 0.01 }

[connections."controller.measured"]
from = "lag.y"
imperfections = [{ kind = "noise", std = 0.05 }]

[measure]
reference = "reference.value"
response = "lag.y"
control = "controller.u"

[variants.soft]
label = "soft PID"

[variants.hard]
components.controller.parameters.kp = 1.0

[study]
seeds = 3
baseline = "soft"
metrics = ["iae"]

[study.fast]
seeds = 2
"""


def write(folder: Path, text: str = FILE) -> Path:
    path = folder / "loops" / "lag.toml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def load(folder: Path, text: str = FILE, *changes: str) -> Experiment:
    """The experiment, changed as by `--set`."""
    return Experiment.load(write(folder, text), settings(changes))


MACHINE = """
title = "A generator under state feedback"
stop_time = 0.5
step = 0.01
seed = 3

[components.plant]
fmu = "single_machine_infinite_bus"
start_values = { angle_deviation = 0.1, speed = 0.5 }

[components.controller]
controller = "lq_regulator"
parameters.model = "controllers.papers.takata.machine_model:MachineParameters"
parameters.Q = [1.0, 1.0]
parameters.R = [1.0]

[connections]
"controller.angle_deviation" = "plant.angle_deviation"
"controller.speed" = { from = "plant.speed", imperfections = [{ kind = "noise", std = 0.1 }] }
"plant.field_deviation" = "controller.u"

[metrics.distance]
kind = "final"
signal = "plant.angle_deviation"
norm_with = ["plant.speed"]

[variants.light]

[variants.heavy]
components.controller.parameters.R = [100.0]

[sweep]
outcome = "distance"
below = 1.0
own_seeds = true

[sweep.x]
key = "components.plant.start_values.angle_deviation"
from = -0.5
to = 0.5
count = 3

[sweep.y]
key = "components.plant.start_values.speed"
from = -1.0
to = 4.0
count = 2

[sweep.fast]
x = 2
y = 2
"""
