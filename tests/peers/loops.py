"""The lead loop, plant and controller as FMUs that another tool wires by its own interface."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness import registry
from harness.bench import Bench
from harness.export.controller import controller_fmu
from harness.system.graph import BlockComponent
from tests.peers.order import Order

STEP = 2.0**-7  # exact both as a float and in nanoseconds: no importer rounds it otherwise
STEPS = 200
TARGET = 1500.0
CONTROLLERS = {
    "pid": {"kp": 2e-4, "ki": 1e-3, "kd": 1e-6},
    "fuzzy_pid": {
        "kp": (1e-4, 4e-4), "ki": (5e-4, 3e-3), "kd": (0.0, 2e-6),
        "error_range": 2000.0, "error_rate_range": 2e4,
    },
}  # fmt: skip


def loop(name: str, version: int, delay: float) -> Bench:
    """In this harness, with a `delay` (s) on the wire from the controller to the plant."""
    bench = Bench(stop_time=STEPS * STEP, step=STEP, fmi_version=version)
    bench.fmu("plant", "hybrid_actuator")
    bench.controller("controller", name, **CONTROLLERS[name])  # type: ignore[arg-type]
    bench.signal("reference", "constant", value=TARGET)
    bench.connect("reference", "controller.reference")
    bench.connect("plant.force", "controller.measured")
    bench.connect("controller.u", "plant.command", delay=delay)
    return bench


def ours(name: str, version: int, delay: float) -> NDArray[np.float64]:
    """Force and control in the order in which another tool shows them after each step."""
    result = loop(name, version, delay).run()
    return np.array([result["plant.force"][1:], result["controller.u"][:-1]]).T


def controller(name: str, version: int, portable: bool) -> Path:
    """The FMU of the loop's controller."""
    component = loop(name, version, 0.0).system().component("controller")
    assert isinstance(component, BlockComponent)
    return controller_fmu(component.block, name, STEP, version, portable=portable)


def order(name: str, version: int, *, portable: bool, controller_first: bool = False) -> Order:
    """What a tool is asked to do."""
    fmus = {
        "plant": str(registry.plant_fmu("hybrid_actuator", version, portable=portable)),
        "controller": str(controller(name, version, portable)),
    }
    return Order(
        fmus=dict(reversed(fmus.items())) if controller_first else fmus,
        step=STEP,
        steps=STEPS,
        outputs=["plant.force", "controller.u"],
        wires=[("plant.force", "controller.measured"), ("controller.u", "plant.command")],
        start_values={"controller.reference": TARGET},
    )
