"""The lead loop, plant and controller as FMUs, under other masters.

A master that steps the controller first and passes its output on for the same step closes the loop
as ours does. Ecos and libcosim step all FMUs at once and pass the outputs on afterwards, so what
the controller computes from y(t_k) acts from t_k+1 on. That is our loop with a delay of one sample
on the wire from the controller to the plant, and it is to the last bit.
"""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness import registry
from harness.bench import Bench
from harness.export.controller import controller_fmu
from harness.system.graph import BlockComponent
from tests.peers.order import Order, run_in
from tests.peers.test_plants_run_in_other_tools import MODULES

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


def loop(name: str, version: int, delay: float) -> tuple[Bench, BlockComponent]:
    bench = Bench(stop_time=STEPS * STEP, step=STEP, fmi_version=version)
    bench.fmu("plant", "hybrid_actuator")
    bench.controller("controller", name, **CONTROLLERS[name])  # type: ignore[arg-type]
    bench.signal("reference", "constant", value=TARGET)
    bench.connect("reference", "controller.reference")
    bench.connect("plant.force", "controller.measured")
    bench.connect("controller.u", "plant.command", delay=delay)
    found = next(c for c in bench.system().components if c.name == "controller")
    assert isinstance(found, BlockComponent)
    return bench, found


def order(controller: Path, version: int) -> Order:
    fmus = {"plant": str(registry.plant_fmu("hybrid_actuator", version))}
    return Order(
        fmus={**fmus, "controller": str(controller)},
        step=STEP,
        steps=STEPS,
        outputs=["plant.force", "controller.u"],
        wires=[("plant.force", "controller.measured"), ("controller.u", "plant.command")],
        start_values={"controller.reference": TARGET},
    )


@pytest.mark.parametrize("name", CONTROLLERS)
@pytest.mark.parametrize(
    ("tool", "version", "portable"),
    [
        ("ecos", 2, False),
        ("ecos", 3, False),
        ("ecos", 2, True),
        ("libcosim", 2, False),
        ("libcosim", 2, True),
    ],
)
def test_one_sample_of_delay_and_not_a_bit_more(
    tool: str, version: int, portable: bool, name: str
) -> None:
    if importlib.util.find_spec(MODULES[tool]) is None:
        pytest.skip(f"{MODULES[tool]} is not installed (extra 'peers')")
    bench, component = loop(name, version, STEP)
    controller = controller_fmu(component.block, name, STEP, version, portable=portable)
    expected = bench.run()
    found = run_in(tool, order(controller, version))
    assert np.ptp(expected["plant.force"]) > TARGET / 2
    assert np.array_equal(found[:, 0], expected["plant.force"][1:])
    assert np.array_equal(found[:, 1], expected["controller.u"][:-1])


@pytest.mark.parametrize("portable", [False, True], ids=["native", "portable"])
@pytest.mark.parametrize("name", CONTROLLERS)
def test_no_delay_where_the_controller_steps_first(name: str, portable: bool) -> None:
    bench, component = loop(name, 2, 0.0)
    controller = controller_fmu(component.block, name, STEP, 2, portable=portable)
    expected = bench.run()
    asked = order(controller, 2)
    found = run_in("fmpy", replace(asked, fmus=dict(reversed(asked.fmus.items()))))
    assert np.array_equal(found[:, 0], expected["plant.force"][1:])
    assert np.array_equal(found[:, 1], expected["controller.u"][:-1])
