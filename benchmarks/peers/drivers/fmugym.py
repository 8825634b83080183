"""FMUGym: the plant's FMU as a Gymnasium environment, the controller in the loop of an agent."""

from typing import Any, ClassVar

import numpy as np
from fmugym import FMUGym, FMUGymConfig, VarSpace

from benchmarks.peers.task import Run, Task, carry_out


class Environment(FMUGym):
    """What a user has to add: a reward."""

    init_states: ClassVar[dict[int, float]] = {}

    def compute_reward(self, *arguments: Any, **named: Any) -> float:
        """None."""
        return 0.0


def box(name: str) -> VarSpace:
    space = VarSpace(name)
    space.add_var_box(name, np.array([-1e6]), np.array([1e6]))
    return space


def prepare(task: Task, steps: int) -> Run:
    environment = Environment(
        FMUGymConfig(
            task.plant, stop_time=2.0 * steps * task.step, sim_step_size=task.step,
            action_step_size=0.5 * task.step, inputs=box("u"), outputs=box("y"),
            random_vars=VarSpace("none"),
        )
    )  # fmt: skip
    compute = task.python_controller()

    def run() -> float:
        seen, _ = environment.reset()
        for _ in range(steps):
            seen, *_ = environment.step(np.array([compute(float(seen[0]))]))
        return float(seen[0])

    return run


carry_out(prepare)
